#include "tests/slam/worlds/drive_world.h"

#include <random>

#include "slam/places/ground_bev.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

constexpr double kLaneLength = 40, kDeckHeight = 3, kSpacing = 2;  // [m]
constexpr int kPointsPerDeck = 500;
constexpr double kSight = 20;           // [m]
constexpr double kBearingSigma = 2e-3;  // [rad]
constexpr double kDepthError = 0.05;
constexpr int kFlippedBits = 8;  // of the 256 of a look, each time it is seen
const Eigen::Vector3d kMounts[] = {
    {3.7, 0, 0.6}, {2, 1, 1}, {-0.9, 0, 0.9}, {2, -1, 1}};  // front, left, rear, right

cv::Mat FloorAround(const Rigid3& world_from_keyframe, std::uint32_t seed) {
  const RenderedRoom room({-100, -100, 0}, {100, 100, 100}, seed);
  cv::Mat floor(kFloorSize, CV_8UC1);
  for (int row = 0; row < floor.rows; ++row) {
    for (int column = 0; column < floor.cols; ++column) {
      Eigen::Vector3d cell =
          world_from_keyframe * Eigen::Vector3d(kFloorFront - (row + 0.5) * kFloorCell,
                                                kFloorLeft - (column + 0.5) * kFloorCell, 0);
      cell.z() = 0;
      floor.at<uchar>(row, column) =
          cv::saturate_cast<uchar>(128 + 0.9 * (room.BrightnessAt(cell, 0.06) - 128));
    }
  }
  return floor;
}

}  // namespace

DriveWorld::DriveWorld(const DriveWorldOptions& options) : options_(options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  looks_ = cv::Mat(kPointsPerDeck * (options.num_decks + 1), 32, CV_8UC1);
  for (int row = 0; row < looks_.rows; ++row)
    for (int k = 0; k < 32; ++k) looks_.at<uchar>(row, k) = static_cast<uchar>(random());
  for (int i = 0; i < kPointsPerDeck; ++i) {
    const Eigen::Vector3d position((0.5 + 0.7 * uniform(random)) * kLaneLength,
                                   15 * uniform(random), 1.2 + 1.1 * uniform(random));
    const bool is_shared = i < options.shared_looks * kPointsPerDeck;
    for (int deck = 0; deck < options.num_decks; ++deck)
      points_.push_back({position + kDeckHeight * deck * Eigen::Vector3d::UnitZ(),
                         is_shared ? i : (deck + 1) * kPointsPerDeck + i});
  }
}

void DriveWorld::Observe(const Rigid3& world_from_keyframe, std::uint32_t seed,
                         RigKeyframe& keyframe) const {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const Rigid3 keyframe_from_world = world_from_keyframe.Inverse();
  for (const Point& point : points_) {
    const Eigen::Vector3d seen = keyframe_from_world * point.position;
    if (seen.norm() > kSight || std::abs(seen.z() - 1.2) > 0.5 * kDeckHeight) continue;
    const int camera =
        static_cast<int>(std::lround(std::atan2(seen.y(), seen.x()) / (M_PI / 2)) + 4) % 4;
    const Eigen::Vector3d view = seen - kMounts[camera];
    if (view.norm() < 1) continue;
    KeyframeFeature feature;
    feature.camera = camera;
    feature.origin = kMounts[camera];
    const Eigen::Vector3d noise(normal(random), normal(random), normal(random));
    feature.bearing = (view.normalized() + kBearingSigma * noise).normalized();
    feature.sigma = kBearingSigma;
    feature.point =
        feature.origin + view.norm() * (1 + kDepthError * normal(random)) * feature.bearing;
    feature.depth_sigma = kDepthError * view.norm();
    keyframe.features.push_back(feature);
    const bool is_wrong = uniform(random) < options_.wrong_share;
    cv::Mat look =
        looks_
            .row(is_wrong ? static_cast<int>(random() % static_cast<unsigned>(looks_.rows))
                          : point.look)
            .clone();
    for (int i = 0; i < kFlippedBits; ++i)
      look.at<uchar>(0, static_cast<int>(random() % 32)) ^=
          static_cast<uchar>(1u << (random() % 8));
    keyframe.descriptors.push_back(look);
  }
}

WorldDrive DriveWorld::Drive(std::uint32_t seed, bool is_opposite,
                             const std::vector<int>& decks) const {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  WorldDrive result;
  std::vector<TrajectoryState> states;
  Rigid3 odom_from_keyframe{ExpSo3({0, 0, 2.0 * seed}), {3.0 * seed, -7.0 * seed, 0.4 * seed}};
  for (const int deck : decks) {
    for (double way = 0; way <= kLaneLength; way += kSpacing) {
      const double x = is_opposite ? kLaneLength - way : way;
      const Rigid3 world_from_keyframe{ExpSo3({0, 0, is_opposite ? M_PI : 0}),
                                       {x, 0.1 * normal(random), kDeckHeight * deck}};
      if (!result.world_from_keyframe.empty()) {
        const Rigid3 step = result.world_from_keyframe.back().Inverse() * world_from_keyframe;
        const Rigid3 drift{ExpSo3({0, 0, 5e-4 * normal(random)}),
                           0.003 * Eigen::Vector3d(normal(random), normal(random), 0)};
        odom_from_keyframe = odom_from_keyframe * step * drift;
      }
      result.world_from_keyframe.push_back(world_from_keyframe);
      RigKeyframe keyframe;
      keyframe.time = Timestamp{static_cast<std::int64_t>(states.size()) * 1'000'000'000};
      keyframe.distance = kSpacing * static_cast<double>(states.size());
      keyframe.odom_from_keyframe = odom_from_keyframe;
      Observe(world_from_keyframe, static_cast<std::uint32_t>(random()), keyframe);
      if (options_.floor_seed > 0)
        keyframe.floor = FloorAround(world_from_keyframe, options_.floor_seed);
      result.drive.keyframes.push_back(std::move(keyframe));
      TrajectoryState state;
      state.time = result.drive.keyframes.back().time;
      state.world_from_body = odom_from_keyframe;
      states.push_back(state);
    }
  }
  result.drive.odom_from_body = Trajectory(std::move(states));
  return result;
}

double WorstOffset(const WorldDrive& a, const Trajectory& site_from_a, const WorldDrive& b,
                   const Trajectory& site_from_b) {
  double worst = 0;
  for (size_t i = 0; i < a.world_from_keyframe.size(); ++i) {
    for (size_t k = 0; k < b.world_from_keyframe.size(); ++k) {
      const Eigen::Vector3d truth =
          (a.world_from_keyframe[i].Inverse() * b.world_from_keyframe[k]).translation;
      if (truth.norm() > kSpacing) continue;
      const Rigid3 &site_from_i = site_from_a.states()[i].world_from_body,
                   &site_from_k = site_from_b.states()[k].world_from_body;
      worst = std::max(worst, ((site_from_i.Inverse() * site_from_k).translation - truth).norm());
    }
  }
  return worst;
}

}  // namespace parkade
