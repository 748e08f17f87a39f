#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "slam/factors/bearing_cost.h"
#include "slam/factors/factor_graph.h"
#include "slam/factors/gnss_cost.h"
#include "slam/factors/linear_prior.h"
#include "slam/smoother/drive_measurements.h"

namespace parkade {

/// A loop as a measured relative pose of the IMU at two nodes.
struct AdjustedLoop {
  size_t from = 0, to = 0;  ///< indices of nodes
  Rigid3 from_from_to;
  Matrix6d square_root_weight = Matrix6d::Identity();  ///< of RelativePoseError
  bool is_used = true;                                 ///< false: looked at, but pulls nothing
};

/// A GNSS fix between node `first` and the next.
struct AdjustedFix {
  size_t first = 0;
  AntennaFix antenna;
};

struct AdjustedNode : NodeBlocks {
  Timestamp time;
  std::optional<NodeInterval> interval;  ///< since the node before
};

struct AdjustedImage {
  int camera = 0;
  size_t first = 0, second = 0;  ///< indices of nodes; the same where the image is at a node
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< bias included
  ImageView geometry;
};

struct AdjustedObservation {
  size_t image = 0;
  Bearing bearing;
  std::unique_ptr<BearingCost> cost;
};

struct AdjustedLandmark {
  LandmarkRay ray;
  double* values = nullptr;
  std::vector<AdjustedObservation> observations;
  bool is_used = true;  ///< false: held out, it shows how good the poses are
};

/// All that is estimated of a whole drive, and all that was measured of it.
struct AdjustedDrive {
  /// The nodes at `start`, and the images between them; no landmarks, priors, loops or fixes yet.
  /// \param max_landmarks  for which there is room
  AdjustedDrive(const DriveMeasurements& measurements, const std::vector<MotionState>& start,
                size_t max_landmarks);

  /// Brings the images' geometry to the states as they are.
  void PointImages();

  ParameterArena arena;
  std::vector<AdjustedNode> nodes;
  std::vector<CameraBlocks> cameras;
  std::vector<CameraSigmas> camera_priors;  ///< 0 of what is not estimated
  double* wheel_scale = nullptr;
  double* site_from_odom = nullptr;  ///< yaw and translation; unused without fixes
  std::vector<AdjustedImage> images;
  std::vector<AdjustedLandmark> landmarks;
  std::vector<LinearPrior> priors;
  std::vector<AdjustedLoop> loops;
  std::vector<AdjustedFix> fixes;

 private:
  void AddNodes(const DriveMeasurements& measurements, const std::vector<MotionState>& start);
  void AddImages(const DriveMeasurements& measurements);
};

}  // namespace parkade
