#include "mapping/texture/choose_images.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace parkade {
namespace {

/// A camera 1.2 m above the ground that looks straight down, 120 degrees wide.
const RigCamera& Camera() {
  static const RigCamera camera = [] {
    RigCamera made;
    made.name = "cam0";
    made.model = CameraModel(
        KannalaBrandtProjection{.fx = 300, .fy = 300, .cx = 319.5, .cy = 239.5}, 640, 480);
    return made;
  }();
  return camera;
}

GroundImage ImageAt(double x) {
  Eigen::Matrix3d site_from_camera;
  site_from_camera.col(0) = Eigen::Vector3d(1, 0, 0);
  site_from_camera.col(1) = Eigen::Vector3d(0, -1, 0);
  site_from_camera.col(2) = Eigen::Vector3d(0, 0, -1);
  GroundImage image;
  image.camera = &Camera();
  image.site_from_camera = {Eigen::Quaterniond(site_from_camera), {x, 0, 1.2}};
  return image;
}

/// Of `num_drives` along the same 20 m, an image every meter, each drive a little aside of the
/// others.
std::vector<GroundImage> Drives(int num_drives) {
  std::vector<GroundImage> images;
  for (int drive = 0; drive < num_drives; ++drive)
    for (int i = 0; i <= 20; ++i) {
      images.push_back(ImageAt(i + 0.037 * drive));
      images.back().drive = drive;
    }
  return images;
}

std::vector<Eigen::Vector3d> Ground(double x0, double x1) {
  std::vector<Eigen::Vector3d> places;
  for (double x = x0; x < x1; x += 0.5)
    for (double y = -2; y < 2; y += 0.5) places.emplace_back(x, y, 0);
  return places;
}

std::vector<bool> Choose(std::vector<GroundImage> images,
                         const std::vector<Eigen::Vector3d>& ground) {
  return ChooseImages(images, ground, 10);
}

long CountChosen(const std::vector<bool>& is_chosen) {
  return std::count(is_chosen.begin(), is_chosen.end(), true);
}

TEST(ChooseImages, ManyDrivesNeedHardlyMorePhotosThanOne) {
  const std::vector<Eigen::Vector3d> ground = Ground(0, 20);
  const long of_one = CountChosen(Choose(Drives(1), ground));
  EXPECT_GT(of_one, 10);

  EXPECT_LT(CountChosen(Choose(Drives(20), ground)), 3 * of_one) << "of 420";
}

TEST(ChooseImages, WhereSomethingStandsInTheWayAnEarlierDriveIsAsked) {
  std::vector<GroundImage> images = Drives(2);
  const SurfaceMap nothing{0.05, {}};
  const CellFinder no_cells(nothing);
  const FreeClearance no_ground(no_cells);
  std::vector<Eigen::Vector3d> ground = Ground(0, 20);
  std::erase_if(ground, [](const auto& place) { return std::abs(place.y()) < 1.2; });  // all see it
  int num_prepared = 0;
  const auto rays = [&](std::size_t i) {
    return FreeRays(images[i].site_from_camera, {}, 10, no_ground);
  };
  const auto choose = [&](bool asks_before) {
    num_prepared = 0;
    return ChooseImages(images, ground, 10,
                        ObstacleChecks{.may_show =
                                           [&](std::size_t i, const Eigen::Vector2d& place) {
                                             return !asks_before || images[i].drive == 0 ||
                                                    rays(i).Reach(place);
                                           },
                                       .prepare =
                                           [&](std::size_t i) {
                                             ++num_prepared;
                                             if (images[i].drive == 1)
                                               images[i].open_ground = VisibilityHorizon(rays(i));
                                           }});
  };
  const std::vector<bool> is_chosen = choose(false);

  EXPECT_GT(std::count(is_chosen.begin(), is_chosen.begin() + 21, true), 10);
  EXPECT_LE(num_prepared, 42);
  EXPECT_GT(num_prepared, 21);
  EXPECT_EQ(choose(true), is_chosen);
  EXPECT_LE(num_prepared, 21) << "what shows nothing is not prepared";
}

TEST(ChooseImages, OfDrivesThatSeeAlikeTheLatestIsChosen) {
  std::vector<GroundImage> images = Drives(1);
  const size_t half = images.size();
  for (int day = 1; day < 5; ++day)
    for (size_t i = 0; i < half; ++i) {
      images.push_back(images[i]);
      images.back().drive = day;
    }

  const std::vector<bool> is_chosen = ChooseImages(images, Ground(0, 20), 10);

  EXPECT_EQ(std::count(is_chosen.begin(), is_chosen.begin() + static_cast<long>(half), true), 0);
  EXPECT_GT(std::count(is_chosen.end() - static_cast<long>(half), is_chosen.end(), true), 10);
}

TEST(ChooseImages, ALaterDriveThatSawPlacesLessSteeplyStillShowsThem) {
  std::vector<GroundImage> images = Drives(1);
  const auto early = static_cast<long>(images.size());
  for (int x = 0; x <= 20; x += 2) {
    images.push_back(ImageAt(x));
    images.back().drive = 1;
  }

  std::vector<Eigen::Vector3d> ground = Ground(0, 20);
  std::erase_if(ground, [](const Eigen::Vector3d& place) {
    return std::abs(place.y()) > 1;
  });  // seen from every 2 m

  const std::vector<bool> is_chosen = ChooseImages(images, ground, 10);

  EXPECT_EQ(std::count(is_chosen.begin(), is_chosen.begin() + early, true), 0);
}

TEST(ChooseImages, WhatOnlyAnEarlierDriveSawIsTakenFromIt) {
  std::vector<GroundImage> images = Drives(1);
  const size_t early = images.size();
  for (double x = 0; x <= 8; x += 0.2) {
    images.push_back(ImageAt(x));
    images.back().drive = 1;
  }

  const std::vector<bool> is_chosen = ChooseImages(images, Ground(0, 20), 10);

  for (size_t i = 13; i < early; ++i) EXPECT_TRUE(is_chosen[i]) << i;
  EXPECT_FALSE(is_chosen[3]);
}

TEST(ChooseImages, DrivesElsewhereTakeNothingFromWhatOneDriveSaw) {
  std::vector<GroundImage> images = Drives(1);
  const auto early = static_cast<long>(images.size());
  for (int drive = 1; drive < 60; ++drive) {
    images.push_back(ImageAt(100));
    images.back().drive = drive;
  }
  std::vector<Eigen::Vector3d> ground = Ground(0, 20);
  const long alone =
      CountChosen(ChooseImages(std::span(images).first(static_cast<size_t>(early)), ground, 10));
  for (const Eigen::Vector3d& place : Ground(95, 105)) ground.push_back(place);

  const std::vector<bool> is_chosen = ChooseImages(images, ground, 10);

  EXPECT_EQ(std::count(is_chosen.begin(), is_chosen.begin() + early, true), alone);
}

TEST(ChooseImages, APhotoOfNoGroundIsNotRead) {
  EXPECT_EQ(CountChosen(Choose(Drives(1), Ground(50, 60))), 0);
  EXPECT_EQ(CountChosen(Choose(Drives(1), {})), 0);
  EXPECT_TRUE(ChooseImages({}, Ground(0, 5), 10).empty());
}

}  // namespace
}  // namespace parkade
