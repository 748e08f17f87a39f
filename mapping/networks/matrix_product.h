#pragma once

#include <cstddef>
#include <functional>

#include "mapping/networks/float_buffer.h"
#include "mapping/networks/layer_finish.h"

namespace parkade {

/// The right side of a product of matrices, depth x width, in the order in which it is read: panels
/// of up to three groups of columns, and in each row after row. Columns are filled up with zeros.
class PackedMatrix {
 public:
  /// \param element  (row, column)
  PackedMatrix(int depth, int width, const std::function<float(int, int)>& element);

  int depth() const { return depth_; }
  std::size_t num_groups() const { return num_groups_; }  ///< groups of a row
  const float* data() const { return packed_.data(); }

 private:
  int depth_;
  std::size_t num_groups_;
  FloatBuffer packed_;
};

/// The left side: rows that begin `step` floats apart, each of `num_parts` parts that begin
/// `part_step` floats apart. Parts and rows may overlap: a row of windows is such a matrix.
struct MatrixRows {
  const float* data = nullptr;
  std::size_t step = 0;
  std::size_t count = 0;
  std::size_t num_parts = 1;  ///< divides the depth
  std::size_t part_step = 0;
};

/// Writes rows of whole groups of columns to `product`, one after the other.
void Multiply(const MatrixRows& rows, const PackedMatrix& matrix, const LayerFinish& finish,
              float* product);

}  // namespace parkade
