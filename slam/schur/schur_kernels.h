#pragma once

#include <cstddef>
#include <span>

#include "slam/schur/schur_structure.h"

namespace parkade {

/// Doubles in a vector: strides of matrices are multiples of it.
inline constexpr int kLanes = 4;

constexpr int RoundUp(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// sum += a a^T + b b^T in the lower triangle and a bit beyond; `width` numbers each, of `stride`
/// that are there.
void AddProducts(const double* a, const double* b, int width, int stride, double* sum);

/// matrix -= x x^T + y y^T + z z^T in the lower triangle, for the three rows of `packed`, each of
/// `count`, whose columns lie in the matrix where `runs` say.
void SubtractProducts(const double* packed, int count, std::span<const SchurRun> runs,
                      double* matrix, std::ptrdiff_t stride);

/// Columns of a matrix, in whole vectors.
struct ColumnRange {
  int begin = 0, end = 0;
};

/// Rows of doubles, one below the other.
struct StridedRows {
  double* values = nullptr;
  std::ptrdiff_t stride = 0;
};

/// matrix -= P^T P in some rows and columns up to the diagonal and a bit beyond, for the kLanes
/// rows of `panel`.
void SubtractPanel(const StridedRows& panel, std::span<const int> rows,
                   std::span<const ColumnRange> columns, const StridedRows& matrix);

/// to[i] -= factor row[i] for i in [begin, end).
void SubtractRow(double factor, const double* row, int begin, int end, double* to);

}  // namespace parkade
