#include "mapping/observation/segment_image.h"

#include "core/error.h"
#include "core/parallel.h"
#include "mapping/networks/level_view.h"

namespace parkade {

FreespaceBelief SegmentImage(const ImageNetworks& networks, const CameraModel& model,
                             const Rigid3& ground_from_camera, const cv::Mat& image) {
  const std::string size = std::to_string(model.width()) + "x" + std::to_string(model.height());
  Require(image.size() == cv::Size(model.width(), model.height()), ErrorCode::kInvalidInput,
          "the camera's images have " + size + " pixels, this one has " +
              std::to_string(image.cols) + "x" + std::to_string(image.rows));
  const std::optional<LevelView> view = LevelView::Of(model, ground_from_camera);
  Require(view.has_value(), ErrorCode::kInvalidInput,
          "the camera sees less than half of the ground around the way that it looks");
  const FreespaceBelief of_view = networks.of_views->Run(view->Show(image));
  const FreespaceBelief of_image = networks.of_images.Run(image);
  FreespaceBelief belief{cv::Mat(image.size(), CV_32FC1), image.size()};
  const bool has_classes = !of_view.classes.empty() || !of_image.classes.empty();
  if (has_classes) belief.classes.create(image.size(), CV_8UC1);
  ParallelFor(static_cast<size_t>(image.rows), [&](size_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < image.cols; ++x) {
      const std::optional<Eigen::Vector3d> bearing = model.Unproject({x, y});
      const Eigen::Vector2f own(static_cast<float>(x), static_cast<float>(y)),
          level = bearing ? view->PixelOf(ground_from_camera.rotation * *bearing) : own;
      const bool is_level = bearing && of_view.Covers(level);
      const FreespaceBelief& source = is_level ? of_view : of_image;
      belief.log_odds.at<float>(y, x) = source.At(is_level ? level : own);
      if (has_classes)
        belief.classes.at<std::uint8_t>(y, x) =
            static_cast<std::uint8_t>(source.ClassAt(is_level ? level : own));
    }
  });
  return belief;
}

}  // namespace parkade
