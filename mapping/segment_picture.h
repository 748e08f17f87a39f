#pragma once

#include "core/camera_model.h"
#include "core/rigid3.h"
#include "mapping/freespace_network.h"

namespace parkade {

/// What the network of level views says of a picture's own pixels; 0 (nothing is known) beyond the view.
/// \param network             FreespaceNetwork::OfLevelViews
/// \param ground_from_camera  z of frame `ground` is up
/// Throws Error{kInvalidInput} where the picture has another size than the model, or LevelView has none of the camera.
FreespaceBelief SegmentPicture(const FreespaceNetwork& network, const CameraModel& model,
                               const Rigid3& ground_from_camera, const cv::Mat& picture);

}  // namespace parkade
