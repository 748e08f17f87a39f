#include "slam/smoother/drive_measurements.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

class Numbers {
 public:
  double Next() { return noise_(random_); }
  Eigen::Vector3d Vector() { return {Next(), Next(), Next()}; }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> noise_;
};

NodeInterval RandomInterval(Numbers& numbers, size_t num_samples) {
  std::vector<ImuSample> samples;
  for (size_t i = 0; i < num_samples; ++i)
    samples.push_back({Timestamp{static_cast<std::int64_t>(1'000'000 * (i + 1))}, numbers.Vector(),
                       numbers.Vector()});
  NodeInterval interval{
      ImuPreintegration(samples, {numbers.Vector(), numbers.Vector()}, ImuCalibration()),
      {},
      false};
  if (num_samples % 2 == 0) interval.wheels.emplace().displacement = numbers.Vector();
  interval.is_still = num_samples % 3 == 0;
  return interval;
}

RecordedImage RandomImage(Numbers& numbers, size_t num_observations) {
  RecordedImage image;
  image.time = {static_cast<std::int64_t>(num_observations)};
  image.camera = static_cast<int>(num_observations % 4);
  image.angular_velocity = numbers.Vector();
  if (num_observations % 2 == 0) image.second_node = 5;
  for (size_t i = 0; i < num_observations; ++i)
    image.observations.push_back({static_cast<std::int64_t>(i), numbers.Vector().cast<float>(),
                                  static_cast<float>(numbers.Next()),
                                  static_cast<float>(numbers.Next())});
  return image;
}

void ExpectEqual(const std::optional<NodeInterval>& a, const std::optional<NodeInterval>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->imu.samples().size(), b->imu.samples().size());
  EXPECT_EQ(a->imu.increment().position, b->imu.increment().position);
  EXPECT_EQ(a->imu.covariance(), b->imu.covariance());
  EXPECT_EQ(a->imu.d_gyroscope(), b->imu.d_gyroscope());
  EXPECT_EQ(a->imu.bias().accelerometer, b->imu.bias().accelerometer);
  EXPECT_EQ(a->is_still, b->is_still);
  ASSERT_EQ(a->wheels.has_value(), b->wheels.has_value());
  if (a->wheels) {
    EXPECT_EQ(a->wheels->displacement, b->wheels->displacement);
  }
}

void ExpectEqual(const RecordedImage& a, const RecordedImage& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.second_node, b.second_node);
  EXPECT_EQ(a.angular_velocity, b.angular_velocity);
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (size_t i = 0; i < a.observations.size(); ++i) {
    EXPECT_EQ(a.observations[i].track, b.observations[i].track);
    EXPECT_EQ(a.observations[i].bearing, b.observations[i].bearing);
    EXPECT_EQ(a.observations[i].sigma, b.observations[i].sigma);
    EXPECT_EQ(a.observations[i].row, b.observations[i].row);
  }
}

TEST(DriveMeasurements, OnDiskTheyAreWhatTheyWereInMemoryToTheLastBit) {
  Numbers numbers;
  std::vector<std::optional<NodeInterval>> intervals;
  std::vector<RecordedImage> images;
  DriveMeasurements measurements{ImuCalibration()};
  for (size_t i = 0; i < 1000; ++i) {  // more than the buffer of the file holds
    intervals.push_back(i == 0 ? std::nullopt : std::optional(RandomInterval(numbers, 2 + i % 40)));
    images.push_back(RandomImage(numbers, i % 61));
    measurements.AddNode({static_cast<std::int64_t>(i), {}, {}}, intervals.back());
    measurements.AddImage(images.back());
    if (i % 100 == 0)
      ExpectEqual(measurements.IntervalBefore(i / 2), intervals[i / 2]);  // while it grows
  }

  ASSERT_EQ(measurements.nodes.size(), intervals.size());
  ASSERT_EQ(measurements.num_images(), images.size());
  for (size_t i = intervals.size(); i-- > 0;) {
    ExpectEqual(measurements.IntervalBefore(i), intervals[i]);
    ExpectEqual(measurements.Image(i), images[i]);
  }
}

}  // namespace
}  // namespace parkade
