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
  ParallelFor(static_cast<size_t>(image.rows), [&](size_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < image.cols; ++x) {
      float& log_odds = belief.log_odds.at<float>(y, x);
      log_odds = of_image.At({static_cast<float>(x), static_cast<float>(y)});
      const std::optional<Eigen::Vector3d> bearing = model.Unproject({x, y});
      if (!bearing) continue;
      const Eigen::Vector2f pixel = view->PixelOf(ground_from_camera.rotation * *bearing);
      if (of_view.Covers(pixel)) log_odds = of_view.At(pixel);
    }
  });
  return belief;
}

}  // namespace parkade
