#include "slam/places/compare_bevs.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "slam/places/ground_bev.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

constexpr int kNumPlaces = 6;

const RenderedRoom kRoom({-40, -40, 0}, {40, 40, 5}, 3), kAnother({-40, -40, 0}, {40, 40, 5}, 4);

/// Keyframes two meters apart, of a drive that begins at `start`, with images of the floor around
/// the car.
struct FloorDrive {
  std::vector<RigKeyframe> keyframes;
  std::vector<Rigid3> room_from_keyframe;
};

FloorDrive DriveOver(const RenderedRoom& room, const Rigid3& start, double light = 1) {
  FloorDrive drive;
  for (int i = 0; i < kNumPlaces; ++i) {
    RigKeyframe keyframe;
    keyframe.odom_from_keyframe.translation.x() = 2 * i;
    drive.room_from_keyframe.push_back(start * keyframe.odom_from_keyframe);
    keyframe.floor = cv::Mat::zeros(kFloorSize, CV_8UC1);
    for (int row = 0; row < kFloorSize.height; ++row) {
      for (int column = 0; column < kFloorSize.width; ++column) {
        const Eigen::Vector3d cell(kFloorFront - (row + 0.5) * kFloorCell,
                                   kFloorLeft - (column + 0.5) * kFloorCell, 0);
        const double lamp = 0.3 + 0.7 * std::exp(-0.05 * cell.squaredNorm());  // moves with the car
        keyframe.floor.at<uchar>(row, column) = cv::saturate_cast<uchar>(
            128 + 0.9 * light * lamp *
                      (room.BrightnessAt(drive.room_from_keyframe.back() * cell, 0.06) - 128));
      }
    }
    keyframe.floor(cv::Rect(80, 40, 40, 120)) = 0;  // the car
    drive.keyframes.push_back(std::move(keyframe));
  }
  return drive;
}

BevAgreement Compare(const FloorDrive& a, const FloorDrive& b, const Rigid3& error = {}) {
  const DriveFloors floors_a(a.keyframes), floors_b(b.keyframes);
  BevAgreement agreement;
  for (size_t i = 0; i < kNumPlaces; ++i)
    for (size_t k = 0; k < kNumPlaces; ++k) {
      const Rigid3 a_from_b = a.room_from_keyframe[i].Inverse() * b.room_from_keyframe[k];
      if (a_from_b.translation.norm() < 3)
        agreement += CompareBevs(floors_a, i, floors_b, k, error * a_from_b);
    }
  return agreement;
}

TEST(CompareBevs, OneFloorFitsInOtherLightAndFromTheOtherDirection) {
  const FloorDrive first = DriveOver(kRoom, {});
  for (const Rigid3& start :
       {Rigid3{ExpSo3({0, 0, 0.1}), {0.7, -0.8, 0}}, Rigid3{ExpSo3({0, 0, M_PI}), {10, 1, 0}}}) {
    const BevAgreement agreement = Compare(first, DriveOver(kRoom, start, 0.4));
    EXPECT_GT(agreement.num_tiles, 80);
    EXPECT_GT(agreement.share(), 0.9);
  }
}

TEST(CompareBevs, AnotherFloorFitsByChance) {
  const BevAgreement agreement = Compare(DriveOver(kRoom, {}), DriveOver(kAnother, {}));
  EXPECT_GT(agreement.num_tiles, 80);
  EXPECT_LT(agreement.share(), 0.15) << "one square in 25, and noise";
}

TEST(CompareBevs, ALinkThatIsAMeterOffDoesNotFit) {
  EXPECT_LT(Compare(DriveOver(kRoom, {}), DriveOver(kRoom, {}), {{}, {0.7, 0.7, 0}}).share(), 0.1);
}

TEST(CompareBevs, JointsOfPlatesTellNothing) {
  const auto with_joints = [](FloorDrive drive) {  // every 1.1 m, on any floor
    for (size_t i = 0; i < kNumPlaces; ++i)
      for (int row = 0; row < kFloorSize.height; ++row)
        for (int column = 0; column < kFloorSize.width; ++column) {
          const Eigen::Vector3d cell(kFloorFront - (row + 0.5) * kFloorCell,
                                     kFloorLeft - (column + 0.5) * kFloorCell, 0);
          const Eigen::Vector3d place = drive.room_from_keyframe[i] * cell;
          uchar& gray = drive.keyframes[i].floor.at<uchar>(row, column);
          const auto is_joint = [](double at) { return at / 1.1 - std::floor(at / 1.1) < 0.15; };
          if (gray != 0 && (is_joint(place.x()) || is_joint(place.y()))) gray = 115;
        }
    return drive;
  };
  const FloorDrive bare = with_joints(DriveOver(kRoom, {}, 0)),
                   stained = with_joints(DriveOver(kRoom, {}));
  EXPECT_LT(Compare(bare, bare).num_tiles, 12) << "it fits at nine places";
  EXPECT_GT(Compare(stained, stained).num_tiles, 80);
  EXPECT_GT(Compare(stained, stained).share(), 0.9);
}

TEST(CompareBevs, TheOwnCarIsNoFloor) {
  const auto with_a_bonnet = [](FloorDrive drive) {
    for (RigKeyframe& keyframe : drive.keyframes)
      for (int i = 0; i < 40; ++i)
        cv::circle(keyframe.floor, {20 + 37 * i % 160, 20 + 53 * i % 160}, 3, {250}, -1);
    return drive;
  };
  const FloorDrive a = with_a_bonnet(DriveOver(kRoom, {})),
                   b = with_a_bonnet(DriveOver(kAnother, {}));
  EXPECT_LT(Compare(a, b).share(), 0.15) << "both cars stand at the same places";
}

TEST(CompareBevs, NeighborsTellHowMuchAFloorShows) {
  const FloorDrive drive = DriveOver(kRoom, {});
  EXPECT_GT(CompareNeighbors(DriveFloors(drive.keyframes), drive.keyframes).share(), 0.9);
  std::vector<RigKeyframe> bare = drive.keyframes;
  for (RigKeyframe& keyframe : bare)
    cv::randn(keyframe.floor, 128, 3);  // a sealed floor, and the camera's noise
  const BevAgreement agreement = CompareNeighbors(DriveFloors(bare), bare);
  EXPECT_GT(agreement.num_tiles, 20);
  EXPECT_LT(agreement.share(), 0.2);
}

TEST(CompareBevs, WithoutImagesThereIsNothingToSay) {
  std::vector<RigKeyframe> keyframes(3);
  const DriveFloors floors(keyframes);
  EXPECT_EQ(CompareNeighbors(floors, keyframes).num_tiles, 0);
  EXPECT_EQ(CompareBevs(floors, 0, floors, 1, {}).share(), 0);
}

}  // namespace
}  // namespace parkade
