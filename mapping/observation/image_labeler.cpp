#include "mapping/observation/image_labeler.h"

#include <algorithm>

#include "core/parallel.h"
#include "mapping/baselines/segment_by_color.h"
#include "mapping/observation/path_seeds.h"

namespace parkade {
namespace {

NetworkView MakeNetworkView(const RigCamera& camera, const GroundGrid& grid,
                            const Rigid3& body_from_ground, bool wants_level) {
  const Rigid3 ground_from_camera = body_from_ground.Inverse() * camera.body_from_camera;
  NetworkView view;
  if (wants_level && !grid.cells.empty())
    view.level = LevelView::Of(camera.model, ground_from_camera);
  view.pixels.reserve(grid.cells.size());
  for (const GroundGridCell& cell : grid.cells) {
    const Eigen::Vector3d point(cell.point_in_ground.x(), cell.point_in_ground.y(), 0);
    view.pixels.push_back(view.level ? view.level->PixelOf(point - ground_from_camera.translation)
                                     : cell.pixel);
  }
  return view;
}

}  // namespace

ImageLabeler::ImageLabeler(const Trajectory& odom_from_body, const Rigid3& body_from_ground,
                           const Rig& rig, std::span<const GroundGrid> grids,
                           const GroundOptions& options)
    : odom_from_body_(&odom_from_body),
      body_from_ground_(body_from_ground),
      contact_(WheelbaseFootprint::Of(rig)),
      grids_(grids),
      options_(&options) {
  if (options.method != "network") return;
  const bool wants_level = options.level_views && options.freespace_model.empty();
  views_ = ParallelMap(grids.size(), [&](size_t i) {
    return MakeNetworkView(rig.cameras[i], grids[i], body_from_ground, wants_level);
  });
  const auto is_level = [](const NetworkView& view) { return view.level.has_value(); };
  if (std::ranges::any_of(views_, is_level)) level_network_ = FreespaceNetwork::OfLevelViews();
  if (!std::ranges::all_of(views_, is_level)) image_network_.emplace(options.freespace_model);
}

GroundLabels ImageLabeler::Label(const ImageWithMask& image, const cv::Mat& colors) const {
  const auto camera = static_cast<size_t>(image.frame.camera);
  const GroundGrid& grid = grids_[camera];
  if (!image.mask.empty()) return {.labels = LabelsFromMask(grid, image.mask), .is_trusted = true};
  if (!views_.empty())
    return LabelsFromBelief(grid, views_[camera].pixels, BeliefOf(image.frame),
                            options_->segmentation);
  const std::vector<std::uint8_t> seeds =
      FindPathSeeds(grid, *odom_from_body_, image.frame.time, body_from_ground_, contact_);
  return {.labels = SegmentByColor(grid, colors, seeds)};
}

FreespaceBelief ImageLabeler::BeliefOf(const CameraFrame& frame) const {
  const std::optional<LevelView>& level = views_[static_cast<size_t>(frame.camera)].level;
  return level ? level_network_->Run(level->Show(frame.image)) : image_network_->Run(frame.image);
}

}  // namespace parkade
