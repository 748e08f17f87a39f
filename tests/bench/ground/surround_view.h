#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/rigid3.h"

namespace parkade {

/// A real fisheye and what it saw once.
struct SurroundCamera {
  std::string name;
  CameraModel model;        ///< ocam
  double fit_error = 0;     ///< [px] rms between the published polynomial and the model's
  Rigid3 camera_from_view;  ///< of frame `view`: x right, y backwards, z down; in the unit of the
                            ///< publisher
  cv::Mat image;            ///< CV_8UC3
  cv::Mat drivable;         ///< CV_8UC1, 255: the built-in network's
};

/// Four cameras around one car above level ground.
struct SurroundRig {
  std::vector<SurroundCamera> cameras;  ///< front, left, back, right
  double ground = 0;                    ///< z of the ground in `view`
};

/// Reads intrinsic/, extrinsic/ and imgs/ as OpenCalib's SensorsCalibration has them for surround
/// views: world-to-image polynomials of the OCamCalib toolbox, to which image-to-world ones are
/// fitted. Throws Error{kNotFound}.
SurroundRig ReadOpenCalib(const std::filesystem::path& folder);

/// How well neighbors agree about the drivable ground that both see: the correlation of local
/// contrast, front-left, front-right, back-left, back-right. \param blur  [texels of 0.1] of both
std::vector<double> AgreementOfNeighbors(const SurroundRig& rig, double blur);

/// Moves all cameras but the front one, and the ground, so that neighbors agree: paint that crosses
/// from one image to the next joins. A pattern search from coarse to fine.
void AlignNeighbors(SurroundRig& rig);

/// The ground from above, each place from the camera nearest to it; green where the network takes
/// it for drivable. \param half_side, texel  of the image, in the publisher's unit
cv::Mat ViewFromAbove(const SurroundRig& rig, double half_side, double texel);

}  // namespace parkade
