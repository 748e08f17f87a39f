#pragma once

#include <cstdint>
#include <vector>

#include "slam/sessions/join_drives.h"

namespace parkade {

struct DriveWorldOptions {
  std::uint32_t seed = 1;
  int num_decks = 1;             ///< 3 m above each other ...
  double shared_looks = 0;       ///< ... this share of their points looks the same on all of them
  double wrong_share = 0.2;      ///< of what a drive sees that looks like something else
  std::uint32_t floor_seed = 0;  ///< of what the floor shows; 0: no images of it
};

/// A drive of which the truth is known.
struct WorldDrive {
  DriveToJoin drive;
  std::vector<Rigid3> world_from_keyframe;
};

/// Random points along a lane of 40 m, and drives that see them with four cameras.
class DriveWorld {
 public:
  explicit DriveWorld(const DriveWorldOptions& options = {});

  /// A drive along the lane, a keyframe every 2 m, whose odometry has a frame of its own and drifts
  /// a little.
  ///
  /// \param is_opposite  from the lane's end to its beginning
  /// \param decks        visited one after the other
  WorldDrive Drive(std::uint32_t seed, bool is_opposite = false,
                   const std::vector<int>& decks = {0}) const;

 private:
  struct Point {
    Eigen::Vector3d position;
    int look = 0;  ///< row of looks_
  };
  void Observe(const Rigid3& world_from_keyframe, std::uint32_t seed, RigKeyframe& keyframe) const;

  DriveWorldOptions options_;
  std::vector<Point> points_;
  cv::Mat looks_;  ///< 32 random bytes each
};

/// [m] by which keyframes of two joined drives lie elsewhere to each other than in truth, the
/// largest.
double WorstOffset(const WorldDrive& a, const Trajectory& site_from_a, const WorldDrive& b,
                   const Trajectory& site_from_b);

}  // namespace parkade
