#pragma once

#include <memory>

#include "core/camera_model.h"
#include "core/rigid3.h"
#include "mapping/networks/freespace_network.h"

namespace parkade {

/// Our own networks, for single images of calibrated cameras.
struct ImageNetworks {
  std::unique_ptr<FreespaceNetwork> of_views = FreespaceNetwork::OfLevelViews();
  FreespaceNetwork of_images{};
};

/// What the network of level views says of an image's own pixels; beyond the view, what that of
/// images says. \param ground_from_camera  z of frame `ground` is up Throws Error{kInvalidInput}
/// where the image has another size than the model, or LevelView has none of the camera.
FreespaceBelief SegmentImage(const ImageNetworks& networks, const CameraModel& model,
                             const Rigid3& ground_from_camera, const cv::Mat& image);

}  // namespace parkade
