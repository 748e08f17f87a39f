#include "tests/simulator/scenes/traffic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/decompositions.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/scenes/pedestrian_mesh.h"
#include "tests/simulator/vehicle/car_mesh.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using PoseAt = std::function<Rigid3(double)>;

constexpr double kStep = 0.1;       // [s] of checks
constexpr double kClearance = 0.7;  // [m]

/// A way driven once, by distance: from the own car's, straight on beyond both ends.
class Track {
 public:
  explicit Track(const Motion& motion) {
    constexpr double kTimeStep = 0.05;
    for (double time = 0; time <= motion.Duration(); time += kTimeStep) {
      const MotionState state = motion.At(time);
      const double ahead =
          (state.world_from_body.rotation.conjugate() * state.velocity_in_world).x();
      runs_back_ = runs_back_ || ahead < -0.05;
      if (distances_.empty() || ahead > 0.02) {
        distances_.push_back(distances_.empty() ? 0 : distances_.back() + ahead * kTimeStep);
        poses_.push_back(state.world_from_body);
      }
      at_time_.push_back(distances_.back());
    }
    duration_ = motion.Duration();
  }

  bool runs_back() const { return runs_back_; }

  /// [m] that the own car has gone at a time.
  double Distance(double time) const {
    const double place =
        std::clamp(time / duration_, 0.0, 1.0) * static_cast<double>(at_time_.size() - 1);
    const size_t index = std::min(static_cast<size_t>(place), at_time_.size() - 2);
    const double share = place - static_cast<double>(index);
    return at_time_[index] * (1 - share) + at_time_[index + 1] * share;
  }

  Rigid3 Pose(double distance) const {
    const double inside = std::clamp(distance, 0.0, distances_.back());
    const auto next = std::upper_bound(distances_.begin() + 1, distances_.end() - 1, inside);
    const size_t index = static_cast<size_t>(next - distances_.begin());
    const double from = distances_[index - 1], to = distances_[index];
    Rigid3 pose = Interpolate(poses_[index - 1], poses_[index],
                              std::clamp((inside - from) / std::max(1e-6, to - from), 0.0, 1.0));
    pose.translation += (distance - inside) * (pose.rotation * Vector3d::UnitX());
    return pose;
  }

 private:
  std::vector<double> distances_, at_time_;
  std::vector<Rigid3> poses_;
  double duration_ = 0;
  bool runs_back_ = false;
};

/// Where one is on a closed polyline after `distance` [m], looking along it, upright.
Rigid3 OnLoop(const std::vector<Vector3d>& loop, double length, double distance) {
  double left = std::fmod(distance, length);
  if (left < 0) left += length;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vector3d &from = loop[i], &to = loop[(i + 1) % loop.size()];
    const double side = (to - from).norm();
    if (left <= side || i + 1 == loop.size()) {
      // The heading turns over the last stretch before a corner.
      const Vector3d& beyond = loop[(i + 2) % loop.size()];
      const double share = side > 0 ? std::min(1.0, left / side) : 0,
                   turn = std::max(0.0, 1 - (side - left) / 0.6);
      const Vector3d ahead =
          (to - from).normalized() * (1 - 0.5 * turn) + (beyond - to).normalized() * (0.5 * turn);
      const double yaw = std::atan2(ahead.y(), ahead.x());
      return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())),
              from + share * (to - from)};
    }
    left -= side;
  }
  return {};
}

double LengthOf(const std::vector<Vector3d>& loop) {
  double length = 0;
  for (size_t i = 0; i < loop.size(); ++i) length += (loop[(i + 1) % loop.size()] - loop[i]).norm();
  return length;
}

/// On the ground nearest to where it is: the way straight on beyond a track's ends knows no hills.
Rigid3 Seated(Rigid3 pose, const Ground& ground) {
  pose.translation.z() = ground.Height(pose.translation.head<2>(), pose.translation.z());
  return pose;
}

/// What takes up room: a rectangle in the plane of a body.
struct Outline {
  PoseAt pose;
  Vector2d low, high;  ///< [m] in its frame
};

/// [m] between two outlines on one level, from points along their edges.
double Distance(const Outline& first, const Outline& second, double time) {
  const Rigid3 second_from_first = second.pose(time).Inverse() * first.pose(time);
  if (std::abs(second_from_first.translation.z()) > 1.7) return 1e9;
  if (second_from_first.translation.norm() > 14) return second_from_first.translation.norm() - 10;
  double best = 1e9;
  for (const double u : {0.0, 0.25, 0.5, 0.75, 1.0})
    for (const double v : {0.0, 0.5, 1.0}) {
      const Vector2d inside = first.low + (first.high - first.low).cwiseProduct(Vector2d(u, v));
      const Vector2d point = (second_from_first * Vector3d(inside.x(), inside.y(), 0)).head<2>();
      best =
          std::min(best, (second.low - point).cwiseMax(point - second.high).cwiseMax(0.0).norm());
    }
  return best;
}

Outline OwnOutline(const Motion& own) {
  const double middle = -RearAxleX(kOwnCarStyle);
  return {[&own](double time) { return own.WorldFromBody(time); },
          {middle - 1.98, -0.95},
          {middle + 1.98, 0.95}};
}

/// Finds room in time and place for movers, one after the other.
class TrafficPlanner {
 public:
  TrafficPlanner(Scene& scene, const Motion& own, std::uint64_t seed)
      : scene_(scene),
        own_(own),
        track_(own),
        random_(seed, 0x72aff1c),
        outlines_{OwnOutline(own)} {}

  void AddCars(int count) {
    const std::shared_ptr<const Track> track = std::make_shared<Track>(track_);
    if (!track->runs_back() && count > 0) {
      const auto with_gap = [&](double gap, double lead) {
        AddCar([&ground = scene_.place.ground, track, gap, lead](double time) {
          return Seated(track->Pose(track->Distance(time + lead) + gap), ground);
        });
      };
      const int placed = static_cast<int>(outlines_.size());
      if (random_.Chance(0.5)) {
        with_gap(random_.Uniform(9, 14), 1.2);
        with_gap(-random_.Uniform(9, 13), -1.2);
      } else {
        with_gap(-random_.Uniform(9, 13), -1.2);
        with_gap(random_.Uniform(9, 14), 1.2);
      }
      count -= static_cast<int>(outlines_.size()) - placed;
    }
    for (int attempt = 0; attempt < 40 && count > 0; ++attempt)
      count -= AddCarOnLane() || (!track->runs_back() && AddCarLater(track));
  }

  void AddPedestrians(int count) {
    const auto& walks = scene_.place.walks;
    if (walks.empty()) return;
    for (int attempt = 0; attempt < 60 && count > 0; ++attempt) {
      const std::vector<Vector3d> walk =
          walks[static_cast<size_t>(random_.Index(static_cast<int>(walks.size())))];
      const double start = random_.Uniform(0, 400), speed = random_.Uniform(0.9, 1.6),
                   length = LengthOf(walk);
      const PoseAt pose = [walk, start, speed, length](double time) {
        return OnLoop(walk, length, start + speed * time);
      };
      const Outline outline{pose, {-0.3, -0.35}, {0.3, 0.35}};
      if (!IsFree(outline)) continue;
      outlines_.push_back(outline);
      AddPedestrian(random_, pose, speed, scene_.movers, scene_.materials);
      --count;
    }
  }

 private:
  bool IsFree(const Outline& outline) const {
    for (double time = 0; time <= own_.Duration(); time += kStep)
      for (const Outline& other : outlines_)
        if (Distance(other, outline, time) < kClearance) return false;
    return true;
  }

  bool AddCar(const PoseAt& pose) {
    const int style = random_.Index(3);
    const double middle = -RearAxleX(style);
    const Outline outline{pose, {middle - 2.4, -0.98}, {middle + 2.4, 0.98}};
    const std::uint64_t seed = random_.Bits();
    if (!IsFree(outline)) return false;
    outlines_.push_back(outline);
    Mesh mesh;
    mesh.Append(MakeCar(style, seed, scene_.materials),
                {Eigen::Quaterniond::Identity(), {middle, 0, 0}});
    scene_.movers.shapes.push_back(std::move(mesh));
    // Its shade lies under its middle, its frame at its rear axle.
    Mover mover{scene_.movers.shapes.size() - 1, pose, {2.0f, 0.8f}};
    mover.center = static_cast<float>(middle);
    scene_.movers.movers.push_back(std::move(mover));
    return true;
  }

  /// A car that drives around on one of the lanes of the place.
  bool AddCarOnLane() {
    const auto& lanes = scene_.place.lanes;
    if (lanes.empty()) return false;
    const std::vector<Vector3d> lane =
        lanes[static_cast<size_t>(random_.Index(static_cast<int>(lanes.size())))];
    const double start = random_.Uniform(0, 1e3), length = LengthOf(lane);
    const Ground& ground = scene_.place.ground;
    return AddCar([lane, start, length, &ground](double time) {
      constexpr double kSpeed = 5;  // [m/s], all the same, so that none meets another
      Rigid3 pose = OnLoop(lane, length, start + kSpeed * time);
      const Vector2d xy = pose.translation.head<2>();
      pose.translation.z() = ground.Height(xy, pose.translation.z());
      pose.rotation = RotationBetween(Vector3d::UnitZ(), ground.Normal(xy, pose.translation.z())) *
                      pose.rotation;
      return pose;
    });
  }

  /// A car that drives the own car's way much earlier or later.
  bool AddCarLater(const std::shared_ptr<const Track>& track) {
    const double lead = random_.Uniform(8, 45) * (random_.Chance(0.6) ? 1 : -1),
                 gap = lead > 0 ? 9 : -9;
    return AddCar([&ground = scene_.place.ground, track, lead, gap](double time) {
      return Seated(track->Pose(track->Distance(time + lead) + gap), ground);
    });
  }

  Scene& scene_;
  const Motion& own_;
  Track track_;
  Random random_;
  std::vector<Outline> outlines_;
};

}  // namespace

void AddTraffic(Scene& scene, const Motion& own, int count, std::uint64_t seed) {
  TrafficPlanner planner(scene, own, seed);
  planner.AddCars(count);
  planner.AddPedestrians(count);
}

double TrafficClearance(const Scene& scene, const Motion& own, double time) {
  const Outline outline = OwnOutline(own);
  double clearance = 1e9;
  for (const Mover& mover : scene.movers.movers) {
    if (mover.half_size.x() <= 0) continue;
    const Vector2d center(mover.center, 0), half = mover.half_size.cast<double>();
    clearance = std::min(
        clearance, Distance(outline, {mover.world_from_mover, center - half, center + half}, time));
  }
  return clearance;
}

}  // namespace parkade::simulator
