#include "server/map_folder/heights_file.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

DriveHeights Example() {
  DriveHeights heights;
  heights.lean.pitch = 0.01;
  heights.plane_errors = 0.5;
  heights.swept = {{TimestampFromSeconds(1), {1, 2, 3}, 1e4F, 0.01F},
                   {TimestampFromSeconds(2), {4, 5, 6}, 2e4F, 0.02F}};
  heights.planes = {{TimestampFromSeconds(3), {7, 8, 9}, 1, 1}};
  Rigid3 pose;
  pose.translation = {1, 2, 3};
  heights.along = {{{{TimestampFromSeconds(1), {}}}, 0}, {{{TimestampFromSeconds(1), pose}}, 2}};
  return heights;
}

TEST(HeightsFile, HoldsHeightsAndThePathsAlongWhichTheyWereMeasured) {
  const DriveHeights read = DecodeHeights(EncodeHeights(Example()));
  EXPECT_EQ(read.lean.pitch, 0.01);
  EXPECT_EQ(read.plane_errors, 0.5);
  ASSERT_EQ(read.swept.size(), 2u);
  EXPECT_EQ(read.swept[1].time, TimestampFromSeconds(2));
  EXPECT_EQ(read.swept[1].point_in_body, Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(read.swept[1].sigma, 0.02F);
  EXPECT_EQ(read.planes.size(), 1u);
  ASSERT_EQ(read.along.size(), 2u);
  EXPECT_EQ(read.along[0].num_swept, 0u);
  EXPECT_EQ(read.along[1].num_swept, 2u);
  EXPECT_EQ(read.along[1].path[0].world_from_frame.translation, Eigen::Vector3d(1, 2, 3));
}

TEST(HeightsFile, RefusesOtherBytes) {
  const std::string bytes = EncodeHeights(Example());
  EXPECT_THROW(DecodeHeights(bytes + "x"), Error);
  EXPECT_THROW(DecodeHeights(bytes.substr(0, bytes.size() - 1)), Error);
  for (const std::uint64_t count : {0, 1, 3}) {
    DriveHeights heights = Example();
    heights.along[1].num_swept = count;
    EXPECT_THROW(DecodeHeights(EncodeHeights(heights)), Error) << count;
  }
}

}  // namespace
}  // namespace parkade
