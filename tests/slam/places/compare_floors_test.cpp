#include "slam/places/compare_floors.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "slam/places/floor_view.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

constexpr int kNumPlaces = 6;

const RenderedRoom kRoom({-40, -40, 0}, {40, 40, 5}, 3), kAnother({-40, -40, 0}, {40, 40, 5}, 4);

/// Places two metres apart, of a drive that begins at `start`, with pictures of the floor around the car.
struct FloorDrive {
  std::vector<Place> places;
  std::vector<Rigid3> room_from_place;
};

FloorDrive DriveOver(const RenderedRoom& room, const Rigid3& start, double light = 1) {
  FloorDrive drive;
  for (int i = 0; i < kNumPlaces; ++i) {
    Place place;
    place.odom_from_place.translation.x() = 2 * i;
    drive.room_from_place.push_back(start * place.odom_from_place);
    place.floor = cv::Mat::zeros(kFloorSize, CV_8UC1);
    for (int row = 0; row < kFloorSize.height; ++row) {
      for (int column = 0; column < kFloorSize.width; ++column) {
        const Eigen::Vector3d cell(kFloorFront - (row + 0.5) * kFloorCell, kFloorLeft - (column + 0.5) * kFloorCell, 0);
        const double lamp = 0.3 + 0.7 * std::exp(-0.05 * cell.squaredNorm());  // moves with the car
        place.floor.at<uchar>(row, column) = cv::saturate_cast<uchar>(
            128 + 0.9 * light * lamp * (room.BrightnessAt(drive.room_from_place.back() * cell, 0.06) - 128));
      }
    }
    place.floor(cv::Rect(80, 40, 40, 120)) = 0;  // the car
    drive.places.push_back(std::move(place));
  }
  return drive;
}

FloorAgreement Compare(const FloorDrive& a, const FloorDrive& b, const Rigid3& error = {}) {
  const DriveFloors floors_a(a.places), floors_b(b.places);
  FloorAgreement agreement;
  for (size_t i = 0; i < kNumPlaces; ++i)
    for (size_t k = 0; k < kNumPlaces; ++k) {
      const Rigid3 a_from_b = a.room_from_place[i].Inverse() * b.room_from_place[k];
      if (a_from_b.translation.norm() < 3) agreement += CompareFloors(floors_a, i, floors_b, k, error * a_from_b);
    }
  return agreement;
}

TEST(CompareFloors, OneFloorFitsInOtherLightAndFromTheOtherDirection) {
  const FloorDrive first = DriveOver(kRoom, {});
  for (const Rigid3& start : {Rigid3{ExpSo3({0, 0, 0.1}), {0.7, -0.8, 0}}, Rigid3{ExpSo3({0, 0, M_PI}), {10, 1, 0}}}) {
    const FloorAgreement agreement = Compare(first, DriveOver(kRoom, start, 0.4));
    EXPECT_GT(agreement.num_tiles, 80);
    EXPECT_GT(agreement.share(), 0.9);
  }
}

TEST(CompareFloors, AnotherFloorFitsByChance) {
  const FloorAgreement agreement = Compare(DriveOver(kRoom, {}), DriveOver(kAnother, {}));
  EXPECT_GT(agreement.num_tiles, 80);
  EXPECT_LT(agreement.share(), 0.15) << "one square in 25, and noise";
}

TEST(CompareFloors, ALinkThatIsAMetreOffDoesNotFit) {
  EXPECT_LT(Compare(DriveOver(kRoom, {}), DriveOver(kRoom, {}), {{}, {0.7, 0.7, 0}}).share(), 0.1);
}

TEST(CompareFloors, TheOwnCarIsNoFloor) {
  const auto with_a_bonnet = [](FloorDrive drive) {
    for (Place& place : drive.places)
      for (int i = 0; i < 40; ++i) cv::circle(place.floor, {20 + 37 * i % 160, 20 + 53 * i % 160}, 3, {250}, -1);
    return drive;
  };
  const FloorDrive a = with_a_bonnet(DriveOver(kRoom, {})), b = with_a_bonnet(DriveOver(kAnother, {}));
  EXPECT_LT(Compare(a, b).share(), 0.15) << "both cars stand at the same places";
}

TEST(CompareFloors, NeighboursTellHowMuchAFloorShows) {
  const FloorDrive drive = DriveOver(kRoom, {});
  EXPECT_GT(CompareNeighbours(DriveFloors(drive.places), drive.places).share(), 0.9);
  std::vector<Place> bare = drive.places;
  for (Place& place : bare) cv::randn(place.floor, 128, 3);  // a sealed floor, and the camera's noise
  const FloorAgreement agreement = CompareNeighbours(DriveFloors(bare), bare);
  EXPECT_GT(agreement.num_tiles, 20);
  EXPECT_LT(agreement.share(), 0.2);
}

TEST(CompareFloors, WithoutPicturesThereIsNothingToSay) {
  std::vector<Place> places(3);
  const DriveFloors floors(places);
  EXPECT_EQ(CompareNeighbours(floors, places).num_tiles, 0);
  EXPECT_EQ(CompareFloors(floors, 0, floors, 1, {}).share(), 0);
}

}  // namespace
}  // namespace parkade
