#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace parkade {

/// All parameter blocks of a graph in one array: Ceres orders blocks by address in places, and the
/// same log must give the same bytes on every run.
class ParameterArena {
 public:
  ParameterArena() = default;
  explicit ParameterArena(size_t capacity) { Reserve(capacity); }
  ParameterArena(const ParameterArena&) = delete;
  ParameterArena& operator=(const ParameterArena&) = delete;

  /// Before the first Add: how many numbers there will be at most.
  void Reserve(size_t capacity) { values_.reserve(capacity); }

  /// The block stays where it is.
  template <size_t N>
  double* Add(const std::array<double, N>& block) {
    assert(values_.size() + N <= values_.capacity());
    values_.insert(values_.end(), block.begin(), block.end());
    return values_.data() + values_.size() - N;
  }

  bool IsFinite() const {
    return std::all_of(values_.begin(), values_.end(),
                       [](double value) { return std::isfinite(value); });
  }
  const std::vector<double>& values() const { return values_; }
  /// Sets all numbers to `values`, as many as there are.
  void Restore(const std::vector<double>& values) {
    assert(values.size() == values_.size());
    std::copy(values.begin(), values.end(), values_.begin());
  }

 private:
  std::vector<double> values_;
};

}  // namespace parkade
