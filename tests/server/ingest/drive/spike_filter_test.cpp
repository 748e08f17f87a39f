#include "server/ingest/drive/spike_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

/// Pushes samples of yaw rates [rad/s], 10 ms apart, and gives back those that came through.
std::vector<double> Filtered(const std::vector<double>& yaw_rates, int* num_spikes = nullptr) {
  SpikeFilter filter;
  std::vector<double> passed;
  const auto keep = [&](const std::optional<Arrival>& arrival) {
    if (arrival) passed.push_back(std::get<ImuSample>(arrival->content).angular_velocity.z());
  };
  Timestamp time{1'000'000'000'000};
  for (const double rate : yaw_rates) {
    const SpikeFilter::Result result =
        filter.Push({time, 0, ImuSample{time, {0, 0, rate}, {0, 0, 9.81}}});
    keep(result.good);
    if (num_spikes) *num_spikes += result.is_spike ? 1 : 0;
    time = time + 0.01;
  }
  keep(filter.Finish());
  return passed;
}

TEST(SpikeFilter, LeavesOutASampleFarFromBothNeighbors) {
  int num_spikes = 0;
  EXPECT_EQ(Filtered({0.1, 0.2, 30, 0.3, 0.2}, &num_spikes),
            (std::vector<double>{0.1, 0.2, 0.3, 0.2}));
  EXPECT_EQ(num_spikes, 1);
}

TEST(SpikeFilter, KeepsMotionHoweverFast) {
  const std::vector<double> ramp = {0, 2, 4, 6, 8, 6, 4, 2, 0}, step = {0, 0, 9, 9, 9, 0, 0};
  EXPECT_EQ(Filtered(ramp), ramp);
  EXPECT_EQ(Filtered(step), step);
}

TEST(SpikeFilter, KeepsTheFirstAndTheLastSample) {
  const std::vector<double> rates = {30, 0.1, 0.2, 30};
  EXPECT_EQ(Filtered(rates), rates) << "each has one neighbor";
}

}  // namespace
}  // namespace parkade
