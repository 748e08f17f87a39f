#include "mapping/observation/observe_ground.h"

#include <algorithm>
#include <cfloat>
#include <numbers>
#include <optional>
#include <sstream>

#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/keyframe_picker.h"
#include "mapping/observation/image_labeler.h"
#include "mapping/observation/masked_image_stream.h"

namespace parkade {
namespace {

constexpr double kSharpLength =
    0.1;  // [m] of ground in one pixel at which an observation says half as much of what is free
// What colors alone guess is wrong far away most often.
constexpr double kGuessRange = 8.0;   // [m] beyond the nearest ground, up to which it is asked
constexpr float kGuessPixel = 0.8F;   // [m] of ground in one pixel, at most ...
constexpr float kGuessMargin = 4.0F;  // [m] ... so far beyond
constexpr float kGuessFreeConfidence =
    0.67F;  // of what it takes for free, beside what it takes for something else
constexpr float kBeyondRange =
    8;  // [m] to which what lies beyond the outline is kept: steps are small
constexpr size_t kImagesPerBatch = 16;  // kept in memory at once; worked on in parallel

/// Near the camera the rays lie closer than the spacing asked for: every how many-th is enough.
int RayStride(const GroundGrid& grid, float range, double spacing) {
  int stride = 1;
  while (2 * stride * grid.angle_step * range <= spacing) stride *= 2;
  return stride;
}

/// [m] up to which a guess is believed: not as far, and not in as long pixels as a mask.
float LastRangeOfGuess(const GroundGrid& grid) {
  float sharp = 0;
  for (size_t i = 0; i < grid.ranges.size() && grid.pixel_lengths[i] <= kGuessPixel; ++i)
    sharp = grid.ranges[i];
  const auto in_reach = static_cast<float>(grid.nearest_range + kGuessRange);
  return grid.ranges.empty() || sharp == grid.ranges.back()
             ? in_reach
             : std::min(in_reach, sharp - kGuessMargin);
}

void LogPlane(const std::string& drive, const Rigid3& body_from_ground) {
  const Eigen::Vector3d normal = body_from_ground.rotation * Eigen::Vector3d::UnitZ();
  std::ostringstream text;
  text << "stage=ground_plane drive=" << drive
       << " depth=" << -normal.dot(body_from_ground.translation) << " normal_in_body=" << normal.x()
       << "," << normal.y() << "," << normal.z();
  LogInfo(text.str());
}

std::vector<GroundGrid> MakeGrids(const Rig& rig, const Rigid3& body_from_ground,
                                  const GroundOptions& options,
                                  std::vector<std::string>& warnings) {
  std::vector<GroundGrid> grids = ParallelMap(rig.cameras.size(), [&](size_t i) {
    return MakeGroundGrid(rig.cameras[i],
                          body_from_ground.Inverse() * rig.cameras[i].body_from_camera,
                          WheelbaseFootprint::Of(rig), options.grid);
  });
  for (size_t i = 0; i < grids.size(); ++i)
    if (grids[i].cells.empty())
      warnings.push_back("camera '" + rig.cameras[i].name + "' sees no ground within " +
                         std::to_string(static_cast<int>(options.grid.max_range)) +
                         " m: it is not mapped");
  return grids;
}

}  // namespace

GroundPatch ObserveImage(const GroundGrid& grid, const CameraFrame& frame, const cv::Mat& colors,
                         GroundLabels&& found, const Rigid3& body_from_ground,
                         const GroundOptions& options) {
  GroundPatch patch{.drive = 0, .camera = frame.camera, .time = frame.time, .samples = {}};
  const std::vector<GroundLabel>& labels = found.labels;
  // Where it is no ground, only its foot is known to stand where its pixels meet the plane.
  HideBehindObstacles(grid, options.segmentation, found);
  const Eigen::Matrix3f rotation = body_from_ground.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = body_from_ground.translation.cast<float>();
  const float last_range = found.is_trusted ? FLT_MAX : LastRangeOfGuess(grid);
  for (int range = 0; range < grid.num_ranges; ++range) {
    const auto at = static_cast<size_t>(range);
    if (grid.ranges[at] > last_range) break;
    const int stride = RayStride(grid, grid.ranges[at], options.grid.spacing);
    const float footprint = grid.ranges[at] - (range > 0 ? grid.ranges[at - 1] : 0);
    // Who sees an outline in longer pixels knows less well where it is.
    const float blur = grid.pixel_lengths[at] / static_cast<float>(kSharpLength);
    const float sharpness = 1 / (1 + blur * blur);
    for (int ray = 0; ray < grid.num_rays; ray += stride) {
      const auto i = static_cast<size_t>(grid.IndexOf(ray, range));
      if (labels[i] == GroundLabel::kUnknown) continue;
      float hint = 1;
      if (labels[i] == GroundLabel::kBeyond) {
        if (grid.ranges[at] > kBeyondRange) continue;
        hint = 0;
      }
      if (labels[i] == GroundLabel::kDoubtful) hint = 0;
      if (labels[i] == GroundLabel::kHidden)
        hint = static_cast<float>(options.segmentation.hidden_confidence);
      if (labels[i] == GroundLabel::kGround && !found.is_trusted) hint = kGuessFreeConfidence;
      const GroundGridCell& cell = grid.cells[i];
      const uchar* color = colors.ptr() + 3 * i;
      const Eigen::Vector3f point_in_ground(cell.point_in_ground.x(), cell.point_in_ground.y(), 0);
      patch.samples.push_back(GroundSample{
          .point_in_body = Eigen::Vector3f(rotation * point_in_ground + translation),
          .blue = color[0],
          .green = color[1],
          .red = color[2],
          .is_free = labels[i] == GroundLabel::kGround || labels[i] == GroundLabel::kDoubtful,
          .surface = found.surfaces.empty() ? SurfaceClass::kUnknown : found.surfaces[i],
          .weight = cell.weight,
          .footprint = footprint,
          .confidence = sharpness * hint * (found.confidence.empty() ? 1 : found.confidence[i])});
    }
  }
  patch.samples.shrink_to_fit();
  return patch;
}

GroundObservation ObserveGround(const DriveLog& log, const Trajectory& odom_from_body,
                                std::span<const Landmark> landmarks, int drive,
                                const GroundOptions& options,
                                const std::function<void(GroundPatch&&)>& keep) {
  options.Validate();
  const Rig& rig = log.rig();
  GroundObservation result;
  result.placements = PlacementsOf(rig);
  const std::optional<Rigid3> body_from_ground =
      EstimateBodyFromGround(rig, odom_from_body, landmarks);
  if (!body_from_ground) {
    result.warnings.push_back(
        "no ground plane was found in drive '" + log.name() +
        "' (the rig has no vehicle.yaml and the landmarks show none): its ground is not mapped");
    return result;
  }
  result.body_from_ground = *body_from_ground;
  if (!rig.vehicle) LogPlane(log.name(), *body_from_ground);
  const std::vector<GroundGrid> grids = MakeGrids(rig, *body_from_ground, options, result.warnings);

  const RepeatedPasses repeated(odom_from_body, options.passes);
  KeyframePicker picker(odom_from_body, rig.cameras.size(), options.keyframe_distance,
                        options.keyframe_angle_deg * std::numbers::pi / 180, &repeated);
  ReadOptions read{.imu = false,
                   .wheels = false,
                   .gnss = false,
                   .images = true,
                   .semantics = options.use_semantics,
                   .grayscale = false,
                   .wants_image = [&](int camera, Timestamp time) {
                     return !grids[static_cast<size_t>(camera)].cells.empty() &&
                            picker.Wants(camera, time);
                   }};
  const ImageLabeler labeler(odom_from_body, *body_from_ground, rig, grids, options);
  MaskedImageStream stream(log.Read(read));
  int num_patches = 0;
  while (true) {
    const std::vector<ImageWithMask> batch = stream.NextBatch(kImagesPerBatch);
    if (batch.empty()) break;
    std::vector<GroundPatch> patches = ParallelMap(batch.size(), [&](size_t i) {
      const CameraFrame& frame = batch[i].frame;
      const GroundGrid& grid = grids[static_cast<size_t>(frame.camera)];
      const cv::Mat colors = SampleColors(grid, frame.image);
      return ObserveImage(grid, frame, colors, labeler.Label(batch[i], colors), *body_from_ground,
                          options);
    });
    for (size_t i = 0; i < batch.size(); ++i) {
      ++result.num_images;
      if (!batch[i].mask.empty()) ++result.num_masks;
      patches[i].drive = drive;
      if (patches[i].samples.empty()) continue;
      ++num_patches;
      if (keep)
        keep(std::move(patches[i]));
      else
        result.patches.push_back(std::move(patches[i]));
    }
  }
  if (num_patches == 0)
    result.warnings.push_back("drive '" + log.name() + "' shows no ground that could be mapped");
  LogInfo("stage=observe_ground drive=" + log.name() +
          " images=" + std::to_string(result.num_images) +
          " masks=" + std::to_string(result.num_masks) + " patches=" + std::to_string(num_patches));
  return result;
}

}  // namespace parkade
