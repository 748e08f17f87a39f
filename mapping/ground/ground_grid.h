#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/option_about.h"
#include "core/rig.h"
#include "mapping/ground/wheelbase_footprint.h"

namespace parkade {

struct GroundGridOptions {
  double max_range =
      16.0;  ///< [m] on level ground, beyond the nearest a camera sees; less where it rises
  double spacing = 0.05;  ///< [m] between samples near the camera
  double max_pixel_length =
      1.2;                     ///< [m] a view so grazing that a pixel covers more road is not used
  double pitch_sigma = 0.005;  ///< [rad] of the body against the road: suspension and attitude
  double curvature_sigma = 0.007;  ///< [1/m] of the road: how fast a plane loses it
  double height_sigma = 0.01;      ///< [m] of the road right at the wheels

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_range", max_range,
          OptionAbout{"Ground is looked at up to this far from the car.", "m", 2, 40});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A place on the road as one camera sees it.
struct GroundGridCell {
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();            ///< [px]
  Eigen::Vector2f point_in_ground = Eigen::Vector2f::Zero();  ///< [m]
  float weight = 0;         ///< inverse variance of its height [1/m^2]
  bool is_visible = false;  ///< in the image, not masked, not under the own car
};

/// Places on the plane z = 0 of frame `ground`, on rays that spread from the point below one
/// camera: what stands on the road hides what follows on its ray. Computed once per camera and
/// drive; an image is then looked up, not projected.
struct GroundGrid {
  int num_rays = 0;
  int num_ranges = 0;
  double angle_step = 0;              ///< [rad] between rays
  double nearest_range = 0;           ///< [m] at which the camera sees its nearest ground
  std::vector<float> ranges;          ///< [m] num_ranges, increasing
  std::vector<float> pixel_lengths;   ///< [m] of ground in one pixel, along the ray, at each range
  std::vector<GroundGridCell> cells;  ///< num_rays x num_ranges; those of one ray lie together

  int IndexOf(int ray, int range) const { return ray * num_ranges + range; }
};

/// The grid of `camera`. Rays and ranges at which nothing is visible are left out. Weights follow
/// sigma_z^2 = (d pitch_sigma)^2 + (curvature_sigma d^2 / 2)^2 + height_sigma^2, d being the
/// distance from the wheel contacts.
GroundGrid MakeGroundGrid(const RigCamera& camera, const Rigid3& ground_from_camera,
                          const WheelbaseFootprint& contact, const GroundGridOptions& options = {});

/// The image's colors at the grid's places, each the mean of the pixels that are nearer to it than
/// to the next ones: single pixels of a fine texture differ from view to view. num_rays x
/// num_ranges, CV_8UC3 (BGR); black where not visible. `image` is CV_8UC1 or CV_8UC3.
cv::Mat SampleColors(const GroundGrid& grid, const cv::Mat& image);

}  // namespace parkade
