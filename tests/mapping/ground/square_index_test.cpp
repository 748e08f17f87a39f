#include "mapping/ground/square_index.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

using Eigen::Vector2d;

TEST(SquareIndex, VisitsAllThatASearchOneByOneFinds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-30, 30);
  std::vector<Vector2d> places(500);
  SquareIndex<size_t> index(2.5);
  for (size_t i = 0; i < places.size(); ++i) {
    places[i] = {place(random), place(random)};
    index.Add(places[i], i);
  }
  for (const double radius : {0.1, 2.5, 7.0}) {
    const Vector2d center(place(random), place(random));
    std::vector<int> visits(places.size());
    index.VisitAround(center, radius, [&](size_t i) { ++visits[i]; });
    for (size_t i = 0; i < places.size(); ++i) {
      EXPECT_LE(visits[i], 1);
      const double distance = (places[i] - center).norm();
      EXPECT_TRUE(distance > radius || visits[i] == 1) << places[i].transpose();
      EXPECT_TRUE(distance <= 2 * (radius + 2.5) || visits[i] == 0) << places[i].transpose();
    }
  }
}

TEST(SquareIndex, ValuesMayBeChanged) {
  SquareIndex<int> index(1);
  index.Add({0.5, 0.5}, 1);
  index.VisitAround({0, 0}, 1, [](int& value) { value = 7; });
  int seen = 0;
  std::as_const(index).VisitAround({0, 0}, 1, [&](const int& value) { seen = value; });
  EXPECT_EQ(seen, 7);
}

TEST(SquareIndex, FarAwayIsAPlaceAsWell) {
  SquareIndex<int> index(0.5);
  index.Add({1e300, -1e300}, 1);
  int count = 0;
  index.VisitAround({1e300, -1e300}, 1, [&](int) { ++count; });
  EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace parkade
