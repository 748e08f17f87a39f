#pragma once

#include "slam/refinement/drive_adjustment.h"

namespace parkade {

struct PieceOptions {
  size_t max_nodes = 3000;  ///< of a drive that is solved at once
  size_t piece_nodes =
      2000;            ///< of a piece of a longer one: what stays in memory grows with drives
  SolveLimits limits;  ///< of each solve
};

int NumPieces(size_t num_nodes, const PieceOptions& options);

/// Moves all nodes of a drive, in time and memory that grow linearly and not at all with its
/// length: at once where it is short; else in pieces that overlap by a quarter, one after the
/// other. Each begins where the one before left it, ends openly, and carries what follows along;
/// what each finds of the calibration is averaged. Then a pose graph of separators, one in twenty
/// nodes and the ends of loops, closes the loops between pieces, and the seams are adjusted once
/// more. Returns the number of steps.
int SolveInPieces(DriveAdjustment& adjustment, const PieceOptions& options);

}  // namespace parkade
