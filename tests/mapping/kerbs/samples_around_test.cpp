#include "mapping/kerbs/samples_around.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <set>

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Whether a direction lies between those to the places, all seen within half a turn.
bool IsBetween(double azimuth, const Vector3d& eye, std::span<const Vector2d> places) {
  const auto azimuth_of = [&](const Vector2d& place) {
    return std::atan2(place.y() - eye.y(), place.x() - eye.x());
  };
  const double first = azimuth_of(places.front());
  double lowest = 0, highest = 0;
  for (const Vector2d& place : places) {
    const double off = std::remainder(azimuth_of(place) - first, 2 * M_PI);
    lowest = std::min(lowest, off), highest = std::max(highest, off);
  }
  const double off = std::remainder(azimuth - first, 2 * M_PI);
  return off >= lowest && off <= highest;
}

TEST(SamplesAround, VisitsWhatLiesBetweenPlaces) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> coordinate(-8, 8);
  PosedGroundPatch posed{};
  posed.site_from_body.translation = {2, -1, 0.5};
  for (int i = 0; i < 4000; ++i) {
    GroundSample sample{};
    sample.point_in_body = Eigen::Vector3f(coordinate(random), coordinate(random), 0);
    posed.patch.samples.push_back(sample);
  }
  const Vector3d eye(2.5, -1.5, 1.7);
  for (int round = 0; round < 200; ++round) {
    const Vector2d middle =
        eye.head<2>() + 6 * Vector2d(std::cos(0.1 * round), std::sin(0.1 * round));
    GroundArea places;
    for (Vector2d& place : places)
      place = middle + 0.2 * Vector2d(coordinate(random), coordinate(random));

    // Others are looked at, too.
    const std::array<GroundArea, 2> areas{places,
                                          GroundArea{Vector2d(8, 8), {8, 9}, {9, 9}, {9, 8}}};
    std::multiset<float> visited, expected;
    SamplesAround(posed, eye, areas).VisitBehind(places, [&](const Eigen::Vector3f& ray, float) {
      visited.insert(ray.x());
    });

    for (const GroundSample& sample : posed.patch.samples) {
      const Vector3d ray = posed.site_from_body * sample.point_in_body.cast<double>() - eye;
      if (IsBetween(std::atan2(ray.y(), ray.x()), eye, places))
        expected.insert(static_cast<float>(ray.x()));
    }
    ASSERT_EQ(visited, expected) << round;
    ASSERT_GT(visited.size(), 5u);
  }
}

TEST(SamplesAround, VisitsAllFromAmongThePlaces) {
  PosedGroundPatch posed{};
  for (int i = 0; i < 100; ++i) {
    GroundSample sample{};
    sample.point_in_body =
        Eigen::Vector3d(5 * std::cos(i), 5 * std::sin(i), 0).cast<float>().eval();
    posed.patch.samples.push_back(sample);
  }
  const GroundArea around{Vector2d(-1, -1), {1, -1}, {-1, 1}, {1, 1}};
  int num_visited = 0;
  SamplesAround(posed, {0, 0, 1.2}, std::span(&around, 1))
      .VisitBehind(around, [&](const Eigen::Vector3f&, float) { ++num_visited; });
  EXPECT_EQ(num_visited, 100);
}

}  // namespace
}  // namespace parkade
