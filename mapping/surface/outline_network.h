#pragma once

#include <memory>
#include <vector>

#include "mapping/ground/surface_links.h"
#include "mapping/surface/surface_painter.h"

namespace parkade {

class NetworkCopies;

/// A network that looks at the painted ground from above and corrects what its observations say of
/// where it can be driven on: rows of cars, kerbs and slots are plain from there, where every
/// observation of them was slanted. It adds to the log-odds of cells, by kMaxCorrection - kDoubt at
/// most: what near observations are sure of stays.
///
/// Part of the program (models/outlines.onnx, with its card); trained by
/// training/train_outlines.py.
class OutlineNetwork {
 public:
  static constexpr float kMaxCorrection = 12;  ///< of log-odds
  static constexpr float kDoubt = 2;  ///< of log-odds: corrections count from here on, since places
                                      ///< look unlike those that it learned from
  static constexpr int kReach =
      32;  ///< pixels of features that a correction depends on, in each direction

  OutlineNetwork();
  ~OutlineNetwork();
  OutlineNetwork(const OutlineNetwork&) = delete;
  OutlineNetwork& operator=(const OutlineNetwork&) = delete;

  /// Corrects the beliefs of seen cells; those that were driven on stay. `links` are those of the
  /// cells (LinkCells). In parallel; thread-safe. A cell depends on those within kReach pixels
  /// alone, whatever else there is.
  void Refine(const SurfaceLinks& links, std::vector<SurfacePainter::PaintedCell>& cells) const;

 private:
  std::unique_ptr<NetworkCopies> copies_;
};

}  // namespace parkade
