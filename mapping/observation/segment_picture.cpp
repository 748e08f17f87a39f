#include "mapping/observation/segment_picture.h"

#include "core/error.h"
#include "core/parallel.h"
#include "mapping/networks/level_view.h"

namespace parkade {

FreespaceBelief SegmentPicture(const PictureNetworks& networks, const CameraModel& model,
                               const Rigid3& ground_from_camera, const cv::Mat& picture) {
  const std::string size = std::to_string(model.width()) + "x" + std::to_string(model.height());
  Require(picture.size() == cv::Size(model.width(), model.height()), ErrorCode::kInvalidInput,
          "the camera's pictures have " + size + " pixels, this one has " + std::to_string(picture.cols) + "x" +
              std::to_string(picture.rows));
  const std::optional<LevelView> view = LevelView::Of(model, ground_from_camera);
  Require(view.has_value(), ErrorCode::kInvalidInput,
          "the camera sees less than half of the ground around the way that it looks");
  const FreespaceBelief of_view = networks.of_views->Run(view->Show(picture));
  const FreespaceBelief of_picture = networks.of_pictures.Run(picture);
  FreespaceBelief belief{cv::Mat(picture.size(), CV_32FC1), picture.size()};
  ParallelFor(static_cast<size_t>(picture.rows), [&](size_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < picture.cols; ++x) {
      float& log_odds = belief.log_odds.at<float>(y, x);
      log_odds = of_picture.At({static_cast<float>(x), static_cast<float>(y)});
      const std::optional<Eigen::Vector3d> bearing = model.Unproject({x, y});
      if (!bearing) continue;
      const Eigen::Vector2f pixel = view->PixelOf(ground_from_camera.rotation * *bearing);
      if (of_view.Covers(pixel)) log_odds = of_view.At(pixel);
    }
  });
  return belief;
}

}  // namespace parkade
