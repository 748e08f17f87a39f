#include "mapping/observation/observe_ground.h"

#include <algorithm>
#include <cfloat>
#include <deque>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/keyframe_picker.h"
#include "mapping/networks/level_view.h"
#include "mapping/observation/path_seeds.h"

namespace parkade {
namespace {

constexpr double kMaskDelay = 0.25;   // [s] of log within which the mask of an image must come
constexpr double kSameImage = 0.002;  // [s] a mask may be stamped this far from its image
// What colors alone guess is wrong far away most often.
constexpr double kGuessRange = 8.0;   // [m] beyond the nearest ground, up to which it is asked
constexpr float kGuessPixel = 0.8F;   // [m] of ground in one pixel, at most ...
constexpr float kGuessMargin = 4.0F;  // [m] ... so far beyond
constexpr float kGuessFreeConfidence =
    0.67F;  // of what it takes for free, beside what it takes for something else
constexpr float kBeyondRange =
    8;  // [m] to which what lies beyond the outline is kept: steps are small
constexpr size_t kImagesPerBatch = 16;  // kept in memory at once; worked on in parallel

struct ImageWithMask {
  CameraFrame frame;
  cv::Mat mask;  ///< empty where the log has none
};

bool IsMaskOf(const SemanticFrame& mask, const CameraFrame& frame) {
  return mask.camera == frame.camera && std::abs(mask.time - frame.time) < kSameImage;
}

/// Joins images with their masks, which may come before or after them.
class MaskedImageStream {
 public:
  explicit MaskedImageStream(std::unique_ptr<RecordStream> stream) : stream_(std::move(stream)) {}

  /// The next images in order of time, up to `count`; fewer only at the end.
  std::vector<ImageWithMask> NextBatch(size_t count) {
    std::vector<ImageWithMask> batch;
    while (batch.size() < count && HasNext()) {
      batch.push_back(std::move(waiting_.front()));
      waiting_.pop_front();
    }
    return batch;
  }

 private:
  /// Reads on until the first image that waits has its mask, or is past hope of one.
  bool HasNext() {
    while (!is_at_end_ &&
           (waiting_.empty() || (waiting_.front().mask.empty() && !IsPastHope(waiting_.front())))) {
      std::optional<SensorRecord> record = stream_->Next();
      if (!record) {
        is_at_end_ = true;
        break;
      }
      last_time_ = TimeOf(*record);
      if (auto* frame = std::get_if<CameraFrame>(&*record)) Add(std::move(*frame));
      if (auto* mask = std::get_if<SemanticFrame>(&*record)) Add(std::move(*mask));
    }
    return !waiting_.empty();
  }

  bool IsPastHope(const ImageWithMask& image) const {
    return last_time_ - image.frame.time > kMaskDelay;
  }

  void Add(CameraFrame frame) {
    ImageWithMask image{std::move(frame), {}};
    for (SemanticFrame& mask : early_masks_)
      if (IsMaskOf(mask, image.frame)) image.mask = mask.mask;
    std::erase_if(early_masks_,
                  [&](const SemanticFrame& mask) { return last_time_ - mask.time > kMaskDelay; });
    waiting_.push_back(std::move(image));
  }

  void Add(SemanticFrame mask) {
    for (ImageWithMask& image : waiting_)
      if (IsMaskOf(mask, image.frame)) {
        image.mask = std::move(mask.mask);
        return;
      }
    early_masks_.push_back(std::move(mask));
  }

  std::unique_ptr<RecordStream> stream_;
  std::deque<ImageWithMask> waiting_;
  std::vector<SemanticFrame> early_masks_;
  Timestamp last_time_{};
  bool is_at_end_ = false;
};

/// What a network is shown of one camera's images, and where in it the cells of the camera's grid
/// lie.
struct NetworkView {
  std::optional<LevelView> level;  ///< empty: the images as they are
  std::vector<Eigen::Vector2f> pixels;
};

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

/// Labels what images show, by the surest means there is: the log's own mask, the network, or
/// colors.
class ImageLabeler {
 public:
  /// Borrows the trajectory, the grids (one per camera of the rig) and the options.
  ImageLabeler(const Trajectory& odom_from_body, const Rigid3& body_from_ground, const Rig& rig,
               std::span<const GroundGrid> grids, const GroundOptions& options)
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

  /// Thread-safe. `colors` are those of SampleColors.
  GroundLabels Label(const ImageWithMask& image, const cv::Mat& colors) const {
    const auto camera = static_cast<size_t>(image.frame.camera);
    const GroundGrid& grid = grids_[camera];
    if (!image.mask.empty()) return {LabelsFromMask(grid, image.mask), {}, true};
    const SegmentGroundOptions& options = options_->segmentation;
    if (!views_.empty())
      return LabelsFromBelief(grid, views_[camera].pixels, BeliefOf(image.frame), options);
    return {SegmentGround(grid, colors,
                          FindPathSeeds(grid, *odom_from_body_, image.frame.time, body_from_ground_,
                                        contact_),
                          options),
            {},
            false};
  }

 private:
  FreespaceBelief BeliefOf(const CameraFrame& frame) const {
    const std::optional<LevelView>& level = views_[static_cast<size_t>(frame.camera)].level;
    return level ? level_network_->Run(level->Show(frame.image)) : image_network_->Run(frame.image);
  }

  const Trajectory* odom_from_body_;
  Rigid3 body_from_ground_;
  WheelbaseFootprint contact_;
  std::span<const GroundGrid> grids_;
  const GroundOptions* options_;
  std::vector<NetworkView> views_;  ///< one per camera; empty: no network is asked
  std::unique_ptr<FreespaceNetwork> level_network_;
  std::optional<FreespaceNetwork> image_network_;
};

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

void GroundOptions::Validate() const {
  Require(keyframe_distance > 0, ErrorCode::kUsage, "keyframe_distance must be > 0 m");
  Require(keyframe_angle_deg > 0, ErrorCode::kUsage, "keyframe_angle_deg must be > 0");
  Require(method == "network" || method == "colors", ErrorCode::kUsage,
          "method must be network or colors");
  grid.Validate();
  segmentation.Validate();
  plane.Validate();
}

GroundPatch ObserveImage(const GroundGrid& grid, const CameraFrame& frame, const cv::Mat& colors,
                         GroundLabels&& found, const Rigid3& body_from_ground,
                         const GroundOptions& options) {
  GroundPatch patch{.drive = 0, .camera = frame.camera, .time = frame.time, .samples = {}};
  std::vector<GroundLabel>& labels = found.labels;
  // Where it is no ground, only its foot is known to stand where its pixels meet the plane.
  HideBehindObstacles(grid, options.segmentation, found.is_trusted, labels);
  const Eigen::Matrix3f rotation = body_from_ground.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = body_from_ground.translation.cast<float>();
  const float last_range = found.is_trusted ? FLT_MAX : LastRangeOfGuess(grid);
  for (int range = 0; range < grid.num_ranges; ++range) {
    const auto at = static_cast<size_t>(range);
    if (grid.ranges[at] > last_range) break;
    const int stride = RayStride(grid, grid.ranges[at], options.grid.spacing);
    const float footprint = grid.ranges[at] - (range > 0 ? grid.ranges[at - 1] : 0);
    // Who sees an outline in longer pixels knows less well where it is.
    const float blur = grid.pixel_lengths[at] / static_cast<float>(options.grid.sharp_length);
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
      patch.samples.push_back(
          {.point_in_body = Eigen::Vector3f(rotation * point_in_ground + translation),
           .blue = color[0],
           .green = color[1],
           .red = color[2],
           .is_free = labels[i] == GroundLabel::kGround || labels[i] == GroundLabel::kDoubtful,
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
  const std::optional<Rigid3> body_from_ground =
      EstimateBodyFromGround(rig, odom_from_body, landmarks, options.plane);
  if (!body_from_ground) {
    result.warnings.push_back(
        "no ground plane was found in drive '" + log.name() +
        "' (the rig has no vehicle.yaml and the landmarks show none): its ground is not mapped");
    return result;
  }
  result.body_from_ground = *body_from_ground;
  if (!rig.vehicle) LogPlane(log.name(), *body_from_ground);
  const std::vector<GroundGrid> grids = MakeGrids(rig, *body_from_ground, options, result.warnings);

  KeyframePicker picker(odom_from_body, rig.cameras.size(), options.keyframe_distance,
                        options.keyframe_angle_deg * std::numbers::pi / 180);
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
