#include "slam/schur/schur_kernels.h"

#include <algorithm>

#include "core/math/vectorized.h"

namespace parkade {

PARKADE_VECTORIZED_FLOATS void AddProducts(const double* __restrict a, const double* __restrict b,
                                           int width, int stride, double* __restrict sum) {
  for (int i = 0; i < width; ++i, sum += stride) {
    const double u = a[i], v = b[i];
    for (int j = 0; j <= i; j += kLanes)
      for (int k = 0; k < kLanes; ++k) sum[j + k] += u * a[j + k] + v * b[j + k];
  }
}

PARKADE_VECTORIZED_FLOATS void SubtractProducts(const double* __restrict packed, int count,
                                                std::span<const SchurRun> runs,
                                                double* __restrict matrix, std::ptrdiff_t stride) {
  const double *x = packed, *y = x + count, *z = y + count;
  for (size_t i = 0; i < runs.size(); ++i) {
    for (int k = 0; k < runs[i].count; ++k) {
      const int at = runs[i].packed + k;
      const double by_x = x[at], by_y = y[at], by_z = z[at];
      double* __restrict row = matrix + (runs[i].column + k) * stride;
      for (size_t j = 0; j <= i; ++j) {
        const int length = j < i ? runs[j].count : k + 1;
        double* __restrict to = row + runs[j].column;
        const double *u = x + runs[j].packed, *v = y + runs[j].packed, *w = z + runs[j].packed;
        for (int c = 0; c < length; ++c) to[c] -= by_x * u[c] + by_y * v[c] + by_z * w[c];
      }
    }
  }
}

PARKADE_VECTORIZED_FLOATS void SubtractPanel(const StridedRows& panel, std::span<const int> rows,
                                             std::span<const ColumnRange> columns,
                                             const StridedRows& matrix) {
  static_assert(kLanes == 4);
  const double *__restrict a = panel.values, *__restrict b = a + panel.stride,
               *__restrict c = b + panel.stride, *__restrict d = c + panel.stride;
  for (const int row : rows) {
    const double by_a = a[row], by_b = b[row], by_c = c[row], by_d = d[row];
    double* __restrict to = matrix.values + row * matrix.stride;
    for (const ColumnRange& range : columns) {
      const int end = std::min(range.end, RoundUp(row + 1));
      for (int i = range.begin; i < end; i += kLanes)
        for (int k = 0; k < kLanes; ++k)
          to[i + k] -= (by_a * a[i + k] + by_b * b[i + k]) + (by_c * c[i + k] + by_d * d[i + k]);
    }
  }
}

PARKADE_VECTORIZED_FLOATS void SubtractRow(double factor, const double* __restrict row, int begin,
                                           int end, double* __restrict to) {
  for (int i = begin; i < end; ++i) to[i] -= factor * row[i];
}

}  // namespace parkade
