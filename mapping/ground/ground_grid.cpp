#include "mapping/ground/ground_grid.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "mapping/ground/image_sampling.h"

namespace parkade {
namespace {

constexpr double kDenseRange = 3.0;  // [m] beyond, the spacing grows in proportion to the range
constexpr int kMaxLooks = 4;         // at the pixels of a cell, along each side
constexpr double kMaxNearestRange =
    15.0;  // [m] a camera that sees no nearer ground is not for mapping

/// Ranges are distances from the point below the camera: as dense as asked near it, then as the
/// rays spread or as the pixels can tell, whichever is coarser.
void MakeRanges(double camera_height, double pixels_per_radian, double farthest,
                const GroundGridOptions& options, GroundGrid& grid) {
  double range = options.spacing;
  while (range <= farthest) {
    const double pixel_length =
        (camera_height * camera_height + range * range) / (camera_height * pixels_per_radian);
    if (pixel_length > options.max_pixel_length) break;
    grid.ranges.push_back(static_cast<float>(range));
    grid.pixel_lengths.push_back(static_cast<float>(pixel_length));
    range += std::max({options.spacing, range * grid.angle_step, 0.5 * pixel_length});
  }
  grid.num_ranges = static_cast<int>(grid.ranges.size());
}

GroundGridCell MakeCell(const RigCamera& camera, const Rigid3& camera_from_ground,
                        const Eigen::Vector2d& point_in_ground, const WheelbaseFootprint& contact,
                        const GroundGridOptions& options) {
  GroundGridCell cell;
  cell.point_in_ground = point_in_ground.cast<float>();
  if (IsUnderCar(point_in_ground, contact)) return cell;
  const Eigen::Vector3d point_in_camera =
      camera_from_ground * Eigen::Vector3d(point_in_ground.x(), point_in_ground.y(), 0);
  const std::optional<Eigen::Vector2d> pixel = camera.model.Project(point_in_camera);
  if (!pixel || !camera.IsUsable(*pixel, 1)) return cell;
  const double distance = contact.DistanceTo(point_in_ground);
  const double from_pitch = distance * options.pitch_sigma;
  const double from_curvature = 0.5 * options.curvature_sigma * distance * distance;
  const double variance = from_pitch * from_pitch + from_curvature * from_curvature +
                          options.height_sigma * options.height_sigma;
  cell.pixel = pixel->cast<float>();
  cell.weight = static_cast<float>(1.0 / variance);
  cell.is_visible = true;
  return cell;
}

/// [m] from the point below the camera to the nearest ground it sees; a narrow lens that looks
/// ahead from high up sees none for the first meters.
double FindNearestRange(const RigCamera& camera, const Rigid3& ground_from_camera,
                        const WheelbaseFootprint& contact, const GroundGridOptions& options) {
  const Rigid3 camera_from_ground = ground_from_camera.Inverse();
  constexpr int kNumAngles = 36;
  for (double range = options.spacing; range < kMaxNearestRange; range += 4 * options.spacing)
    for (int i = 0; i < kNumAngles; ++i) {
      const double angle = 2 * std::numbers::pi * i / kNumAngles;
      const Eigen::Vector2d point = ground_from_camera.translation.head<2>() +
                                    range * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      if (MakeCell(camera, camera_from_ground, point, contact, options).is_visible) return range;
    }
  return 0;
}

/// Leaves out rays without a visible place. Rays that remain keep their order, so neighbors stay
/// neighbors.
void DropBlindRays(GroundGrid& grid) {
  std::vector<GroundGridCell> kept;
  int num_kept = 0;
  for (int ray = 0; ray < grid.num_rays; ++ray) {
    const auto begin = grid.cells.begin() + grid.IndexOf(ray, 0);
    const auto end = begin + grid.num_ranges;
    if (std::none_of(begin, end, [](const GroundGridCell& cell) { return cell.is_visible; }))
      continue;
    kept.insert(kept.end(), begin, end);
    ++num_kept;
  }
  grid.cells = std::move(kept);
  grid.num_rays = num_kept;
}

const GroundGridCell* VisibleAt(const GroundGrid& grid, int ray, int range) {
  if (ray < 0 || range < 0 || ray >= grid.num_rays || range >= grid.num_ranges) return nullptr;
  const GroundGridCell& cell = grid.cells[static_cast<size_t>(grid.IndexOf(ray, range))];
  return cell.is_visible ? &cell : nullptr;
}

/// [px] from one cell to the next. Neighbors that are not visible are null.
Eigen::Vector2f PixelStep(const GroundGridCell* before, const GroundGridCell& cell,
                          const GroundGridCell* after) {
  if (before && after) return 0.5F * (after->pixel - before->pixel);
  if (before) return cell.pixel - before->pixel;
  return after ? Eigen::Vector2f(after->pixel - cell.pixel) : Eigen::Vector2f::Zero();
}

/// BGR of what lies around a pixel between half a step to all sides, looked at about once per
/// pixel.
cv::Vec3b MeanColor(const cv::Mat& image, const Eigen::Vector2f& pixel,
                    const Eigen::Vector2f& across, const Eigen::Vector2f& along) {
  const auto looks_along = [](const Eigen::Vector2f& step) {
    return std::clamp(static_cast<int>(std::lround(step.norm())), 1, kMaxLooks);
  };
  const int num_across = looks_along(across), num_along = looks_along(along);
  const Eigen::Array2f last(static_cast<float>(image.cols - 1), static_cast<float>(image.rows - 1));
  std::array<float, 3> sum{};
  for (int i = 0; i < num_along; ++i)
    for (int k = 0; k < num_across; ++k) {
      const float on_along = (static_cast<float>(i) + 0.5F) / static_cast<float>(num_along) - 0.5F;
      const float on_across =
          (static_cast<float>(k) + 0.5F) / static_cast<float>(num_across) - 0.5F;
      const Eigen::Array2f at =
          (pixel + on_across * across + on_along * along).array().max(0).min(last);
      const std::array<float, 3> color = ColorAt(image, at.x(), at.y());
      for (size_t c = 0; c < 3; ++c) sum[c] += color[c];
    }
  cv::Vec3b mean;
  for (int c = 0; c < 3; ++c)
    mean[c] = static_cast<uchar>(
        sum[static_cast<size_t>(c)] / static_cast<float>(num_across * num_along) + 0.5F);
  return mean;
}

}  // namespace

void GroundGridOptions::Validate() const {
  Require(spacing > 0 && spacing < kDenseRange, ErrorCode::kUsage, "spacing must be in (0, 3) m");
  Require(max_range > spacing, ErrorCode::kUsage, "max_range must exceed spacing");
  Require(max_pixel_length > 0, ErrorCode::kUsage, "max_pixel_length must be > 0 m");
  Require(pitch_sigma >= 0 && curvature_sigma >= 0, ErrorCode::kUsage,
          "pitch_sigma and curvature_sigma must not be negative");
  Require(height_sigma > 0, ErrorCode::kUsage, "height_sigma must be > 0 m");
}

GroundGrid MakeGroundGrid(const RigCamera& camera, const Rigid3& ground_from_camera,
                          const WheelbaseFootprint& contact, const GroundGridOptions& options) {
  const Eigen::Vector3d center = ground_from_camera.translation;
  GroundGrid grid;
  grid.angle_step = options.spacing / kDenseRange;
  const Eigen::Vector2d middle(0.5 * camera.model.width(), 0.5 * camera.model.height());
  const std::optional<double> pixels_per_radian = camera.model.PixelsPerRadian(middle);
  if (center.z() <= 0.1 || !pixels_per_radian) return grid;

  grid.nearest_range = FindNearestRange(camera, ground_from_camera, contact, options);
  MakeRanges(center.z(), *pixels_per_radian, grid.nearest_range + options.max_range, options, grid);
  grid.num_rays = static_cast<int>(std::floor(2 * std::numbers::pi / grid.angle_step));
  grid.cells.reserve(static_cast<size_t>(grid.num_rays * grid.num_ranges));
  // Rays start opposite to where the camera looks: the seam lies where it sees nothing.
  const Eigen::Vector3d axis_in_ground = ground_from_camera.rotation * Eigen::Vector3d::UnitZ();
  const double seam = std::atan2(-axis_in_ground.y(), -axis_in_ground.x());
  const Rigid3 camera_from_ground = ground_from_camera.Inverse();
  for (int ray = 0; ray < grid.num_rays; ++ray) {
    const double angle = seam + (ray + 0.5) * grid.angle_step;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    for (const float range : grid.ranges)
      grid.cells.push_back(MakeCell(camera, camera_from_ground,
                                    center.head<2>() + range * direction, contact, options));
  }
  DropBlindRays(grid);
  return grid;
}

cv::Mat SampleColors(const GroundGrid& grid, const cv::Mat& image) {
  cv::Mat colors(std::max(grid.num_rays, 1), std::max(grid.num_ranges, 1), CV_8UC3,
                 cv::Scalar(0, 0, 0));
  for (int ray = 0; ray < grid.num_rays; ++ray)
    for (int range = 0; range < grid.num_ranges; ++range) {
      const GroundGridCell& cell = grid.cells[static_cast<size_t>(grid.IndexOf(ray, range))];
      if (!cell.is_visible) continue;
      const Eigen::Vector2f across =
          PixelStep(VisibleAt(grid, ray - 1, range), cell, VisibleAt(grid, ray + 1, range));
      const Eigen::Vector2f along =
          PixelStep(VisibleAt(grid, ray, range - 1), cell, VisibleAt(grid, ray, range + 1));
      colors.at<cv::Vec3b>(ray, range) = MeanColor(image, cell.pixel, across, along);
    }
  return colors;
}

}  // namespace parkade
