#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "core/surface_class.h"

namespace parkade {

/// How sure a network is that the pixels of one image show drivable ground, and what they show.
struct FreespaceBelief {
  cv::Mat
      log_odds;  ///< CV_32FC1 over the whole image, most often coarser than it; 0: nothing is known
  cv::Size image_size;   ///< [px]
  cv::Mat classes = {};  ///< CV_8UC1, as large: the likeliest SurfaceClass; empty: not told

  /// Log-odds of "drivable" at a pixel of the image, bilinear; off the image: at its border.
  float At(const Eigen::Vector2f& pixel) const;

  /// At the place nearest to a pixel.
  SurfaceClass ClassAt(const Eigen::Vector2f& pixel) const;

  /// Whether a pixel lies on the image.
  bool Covers(const Eigen::Vector2f& pixel) const;

  /// CV_8UC1 of the image's size: 255 where drivable is the likelier, 0 elsewhere.
  cv::Mat Mask() const;
};

/// A network that tells drivable ground from everything else, run on one core: Parkade's
/// own by LayeredNetwork, others by OpenCV's dnn.
///
/// The ONNX file must take one image, 1 x 3 x H x W (BGR, 0 to 255, resized to W x H; where the
/// file leaves the size open: 320 x 208), and give 1 x 1 x h x w, the log-odds of "drivable", 1 x 2
/// x h x w, the scores of "other" and "drivable" before their softmax, or 1 x 9 x h x w, those of
/// SurfaceClass. Parkade's own (models/) is part of the program.
class FreespaceNetwork {
 public:
  /// Reads `file`, or takes Parkade's own network where it is empty. Throws Error{kNotFound}
  /// without a file, and Error{kInvalidInput} where it is no ONNX that OpenCV can run, or one of
  /// other inputs and outputs.
  explicit FreespaceNetwork(const std::filesystem::path& file = {});

  /// Parkade's own network for what LevelView shows (models/level.onnx).
  static std::unique_ptr<FreespaceNetwork> OfLevelViews();
  ~FreespaceNetwork();
  FreespaceNetwork(const FreespaceNetwork&) = delete;
  FreespaceNetwork& operator=(const FreespaceNetwork&) = delete;

  /// `image` is CV_8UC1 or CV_8UC3 (BGR), of any size. Of drivable islands smaller than half a
  /// hundredth of the image nothing is known: they are specks on walls and ceilings more often than
  /// ground. Thread-safe: every caller has a copy of the network to itself.
  FreespaceBelief Run(const cv::Mat& image) const;

  /// [px] that images of a size are resized to: what the file asks for. Parkade's own network takes
  /// them in their own proportions, within the size that it was trained at: squeezed as those of
  /// 4:3 would be, walls pass for floor.
  cv::Size InputSizeFor(const cv::Size& image) const;

 private:
  class Copies;
  /// Throws Error{kInvalidInput} that begins with `name`.
  FreespaceNetwork(std::string model, bool is_own, const std::string& name);

  std::unique_ptr<Copies> copies_;
};

}  // namespace parkade
