#include "mapping/roadside/lane_slots.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr double kUsualPitch = 6.1, kPitchSigma = 0.35;  // [m] of slots along kerbs
constexpr double kCarSigma = 0.4;                        // [m] by which a car stands off its slot
constexpr double kMaxOff = 1.4;                          // [m] the same, of one that is of the row
constexpr double kMinCar = 3.0, kMaxCar = 5.7;           // [m]
constexpr double kMaxChink = 0.4;                        // [m] in the flank of one car
constexpr int kMaxFree = 3;                              // slots between two cars of a row
constexpr double kClear = 0.6;    // of a free slot that must be seen to be bare
constexpr double kKeptClear = 5;  // [m] before and behind a junction, by law in most places
constexpr double kMargin = 0.4;   // [m] at the ends of a slot that its neighbors may cover

constexpr double kOfCar = 0.9, kOfLoneCar = 0.75, kBetween = 0.8, kAtEnd = 0.6;  // confidences

using Cars = std::vector<double>;  // [m] along the lane, their middles

/// Cars by the runs of their flanks; those that stand bumper to bumper share one.
Cars FindCars(std::span<const LaneState> states, double step) {
  Cars cars;
  const int count = static_cast<int>(states.size());
  const auto is_car = [&](int i) {
    return states[static_cast<std::size_t>(i)] == LaneState::kVehicle;
  };
  const int chink = static_cast<int>(kMaxChink / step);
  for (int i = 0; i < count;) {
    if (!is_car(i)) {
      ++i;
      continue;
    }
    int end = i + 1;
    for (int next = end; next < count && next - end <= chink; ++next)
      if (is_car(next)) end = next + 1;
    const double begin = i * step, length = (end - i) * step;
    const int held =
        length <= kMaxCar ? 1 : static_cast<int>(std::lround((length + 1.2) / kUsualPitch));
    if (length >= kMinCar)
      for (int car = 0; car < held; ++car) cars.push_back(begin + (car + 0.5) * length / held);
    i = end;
  }
  return cars;
}

/// A row: cars with the numbers of their slots.
struct Row {
  Cars cars;
  std::vector<int> numbers;
  double origin = 0, pitch = kUsualPitch;  // middle of slot 0; [m]

  double At(int number) const { return origin + number * pitch; }

  /// Least squares of where cars stand, with what is usual.
  void Fit() {
    double n = 0, k = 0, kk = 0, c = 0, kc = 0;
    for (std::size_t i = 0; i < cars.size(); ++i) {
      n += 1, k += numbers[i], kk += numbers[i] * numbers[i];
      c += cars[i], kc += numbers[i] * cars[i];
    }
    const double prior = (kCarSigma * kCarSigma) / (kPitchSigma * kPitchSigma);
    const double determinant = n * (kk + prior) - k * k;
    pitch = (n * (kc + prior * kUsualPitch) - k * c) / determinant;
    origin = (c - pitch * k) / n;
  }
};

std::vector<Row> FindRows(const Cars& cars) {
  std::vector<Row> rows;
  for (const double car : cars) {
    if (!rows.empty()) {
      Row& row = rows.back();
      const int number =
          row.numbers.back() +
          std::max(1, static_cast<int>(std::lround((car - row.cars.back()) / row.pitch)));
      const bool is_near = number - row.numbers.back() <= kMaxFree + 1;
      const double expected =
          0.5 * (row.At(number) + row.cars.back() + (number - row.numbers.back()) * row.pitch);
      if (is_near && std::abs(car - expected) < kMaxOff) {
        row.cars.push_back(car), row.numbers.push_back(number);
        row.Fit();
        continue;
      }
    }
    rows.push_back({{car}, {0}, car});
  }
  return rows;
}

bool IsBare(std::span<const LaneState> states, double step, double begin, double end) {
  int free = 0, all = 0;
  for (int i = static_cast<int>(std::ceil((begin + kMargin) / step)); i * step < end - kMargin;
       ++i) {
    ++all;
    if (i < 0 || i >= static_cast<int>(states.size())) continue;
    const LaneState state = states[static_cast<std::size_t>(i)];
    if (state == LaneState::kBlocked || state == LaneState::kVehicle) return false;
    free += state == LaneState::kFree;
  }
  return free > kClear * all;
}

/// Whether the kerb goes on for a while: nobody parks right before a junction.
bool GoesOn(std::span<const LaneState> states, double step, double begin, double end) {
  for (int i = static_cast<int>(begin / step); i * step < end; ++i)
    if (i >= 0 && i < static_cast<int>(states.size()) &&
        states[static_cast<std::size_t>(i)] == LaneState::kBlocked)
      return false;
  return true;
}

}  // namespace

std::vector<LaneSlot> FindLaneSlots(std::span<const LaneState> states, double step) {
  std::vector<LaneSlot> slots;
  for (const Row& row : FindRows(FindCars(states, step))) {
    const double half = 0.5 * row.pitch;
    const auto add = [&](double middle, double confidence, bool is_occupied) {
      if (!is_occupied && !IsBare(states, step, middle - half, middle + half)) return;
      if (!slots.empty() && slots.back().Middle() > middle - 0.7 * row.pitch) return;
      slots.push_back({middle - half, middle + half, confidence, is_occupied});
    };
    const double first = row.At(-1) - half, last = row.At(row.numbers.back() + 1) + half;
    if (GoesOn(states, step, first - kKeptClear, first)) add(row.At(-1), kAtEnd, false);
    for (std::size_t i = 0; i < row.cars.size(); ++i) {
      if (i > 0)
        for (int number = row.numbers[i - 1] + 1; number < row.numbers[i]; ++number)
          add(row.At(number), kBetween, false);
      add(row.At(row.numbers[i]), row.cars.size() > 1 ? kOfCar : kOfLoneCar, true);
    }
    if (GoesOn(states, step, last, last + kKeptClear))
      add(row.At(row.numbers.back() + 1), kAtEnd, false);
  }
  return slots;
}

}  // namespace parkade
