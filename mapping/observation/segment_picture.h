#pragma once

#include <memory>

#include "core/camera_model.h"
#include "core/rigid3.h"
#include "mapping/networks/freespace_network.h"

namespace parkade {

/// Our own networks, for single pictures of calibrated cameras.
struct PictureNetworks {
  std::unique_ptr<FreespaceNetwork> of_views = FreespaceNetwork::OfLevelViews();
  FreespaceNetwork of_pictures{};
};

/// What the network of level views says of a picture's own pixels; beyond the view, what that of pictures says.
/// \param ground_from_camera  z of frame `ground` is up
/// Throws Error{kInvalidInput} where the picture has another size than the model, or LevelView has none of the camera.
FreespaceBelief SegmentPicture(const PictureNetworks& networks, const CameraModel& model,
                               const Rigid3& ground_from_camera, const cv::Mat& picture);

}  // namespace parkade
