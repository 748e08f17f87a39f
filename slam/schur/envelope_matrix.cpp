#include "slam/schur/envelope_matrix.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace parkade {

EnvelopeMatrix::EnvelopeMatrix(std::vector<int> first_columns)
    : stride_(RoundUp(static_cast<int>(first_columns.size()))),
      first_columns_(std::move(first_columns)) {
  for (size_t i = 0; i < first_columns_.size(); ++i) {
    assert(first_columns_[i] >= 0 && first_columns_[i] <= static_cast<int>(i));
    first_columns_[i] -= first_columns_[i] % kLanes;
    if (i % kLanes == 0) first_of_vectors_.push_back(first_columns_[i]);
    first_of_vectors_.back() = std::min(first_of_vectors_.back(), first_columns_[i]);
  }
  first_columns_.push_back(0);
  values_.resize(first_columns_.size() * static_cast<size_t>(stride_));
  panel_.resize(kLanes * static_cast<size_t>(stride_ + kLanes));
}

void EnvelopeMatrix::SetZero() { std::fill(values_.begin(), values_.end(), 0.0); }

bool EnvelopeMatrix::FactorDiagonal(int begin, int count) {
  for (int i = 0; i < count; ++i) {
    double* row = Row(begin + i) + begin;
    for (int j = 0; j <= i; ++j) {
      const double* other = Row(begin + j) + begin;
      double sum = row[j];
      for (int k = 0; k < j; ++k) sum -= row[k] * other[k];
      if (j < i) {
        row[j] = sum / other[j];
      } else {
        if (!(sum > 0)) return false;
        row[j] = std::sqrt(sum);
      }
    }
  }
  return true;
}

void EnvelopeMatrix::FindRows(int begin, int count) {
  rows_.clear();
  row_vectors_.clear();
  for (int row = begin + count; row <= size(); ++row)
    if (first_columns_[static_cast<size_t>(row)] <= begin) rows_.push_back(row);
  for (int row = begin + kLanes; row < size(); row += kLanes) {
    if (first_of_vectors_[static_cast<size_t>(row / kLanes)] > begin) continue;
    if (row_vectors_.empty() || row_vectors_.back().end < row) row_vectors_.push_back({row, row});
    row_vectors_.back().end = row + kLanes;
  }
}

/// Divides what is below a block of the diagonal by it, and copies it to the panel.
void EnvelopeMatrix::DivideRows(int begin, int count) {
  const std::ptrdiff_t height = stride_ + kLanes;
  std::fill(panel_.begin(), panel_.end(), 0.0);
  for (const int row : rows_) {
    double* values = Row(row) + begin;
    for (int i = 0; i < count; ++i) {
      const double* diagonal = Row(begin + i) + begin;
      for (int k = 0; k < i; ++k) values[i] -= values[k] * diagonal[k];
      values[i] /= diagonal[i];
      panel_[static_cast<size_t>(i * height + row)] = values[i];
    }
  }
}

std::optional<Eigen::VectorXd> EnvelopeMatrix::Solve(const Eigen::VectorXd& b) {
  assert(b.size() == size());
  std::copy(b.begin(), b.end(), Row(size()));
  for (int begin = 0; begin < size(); begin += kLanes) {
    const int count = std::min(kLanes, size() - begin);
    if (!FactorDiagonal(begin, count)) return std::nullopt;
    FindRows(begin, count);
    DivideRows(begin, count);
    SubtractPanel({panel_.data(), stride_ + kLanes}, rows_, row_vectors_,
                  {values_.data(), stride_});
  }
  Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(Row(size()), size());
  for (int i = size() - 1; i >= 0; --i) {
    x[i] /= Row(i)[i];
    SubtractRow(x[i], Row(i), first_columns_[static_cast<size_t>(i)], i, x.data());
  }
  return x;
}

}  // namespace parkade
