#include "mapping/texture/ground_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/math/statistics.h"
#include "mapping/ground/image_sampling.h"

namespace parkade {
namespace {

constexpr double kSteepest = 0.17;  // of ramps: what lies higher or lower is another deck's, ...
constexpr double kDeckStep = 0.1;   // [m] ... but for this little, ...
constexpr double kDeckHeight =
    2.0;  // [m] ... and so is all that lies so much off the plane that the car stands on
constexpr double kOwnShade =
    1.3;  // [m] beside the contact area the car's own shadow lies most of the time ...
constexpr double kShadeRim = 0.6;  // [m] ... and beyond that less and less
constexpr double kShadePenalty =
    0.3;  // of the rank of observations in there: further cameras saw the place in the light
constexpr double kShadeMargin =
    0.25;                          // [m] of the car: poses, its size and the sun's are not exact
constexpr double kInShade = 0.04;  // of the rank, where the sun is known: seen so or not at all
constexpr size_t kMinGainSamples = 60;  // fewer say nothing about the exposure
constexpr float kMaxGain = 3;

}  // namespace

GroundProjector::GroundProjector(const GroundImage& image, double max_range)
    : image_(&image),
      max_range_(max_range),
      camera_from_site_(image.site_from_camera.Inverse()),
      ground_from_site_(image.site_from_ground.Inverse()),
      car_(image.contact, kShadeMargin) {
  if (image.to_sun) to_sun_in_ground_ = ground_from_site_.rotation * *image.to_sun;
}

std::optional<Eigen::Vector2d> GroundProjector::PixelOf(
    const Eigen::Vector3d& point_in_site) const {
  return PixelOf(point_in_site, ground_from_site_ * point_in_site);
}

std::optional<Eigen::Vector2d> GroundProjector::PixelOf(
    const Eigen::Vector3d& point_in_site, const Eigen::Vector3d& point_in_ground) const {
  const double height_of_deck =
      std::min(kDeckHeight, kDeckStep + kSteepest * point_in_ground.head<2>().norm());
  if (std::abs(point_in_ground.z()) > height_of_deck) return {};
  if (IsUnderCar(point_in_ground.head<2>(), image_->contact)) return {};
  std::optional<Eigen::Vector2d> pixel =
      image_->camera->model.Project(camera_from_site_ * point_in_site);
  if (!pixel || !image_->camera->IsUsable(*pixel, 1)) return {};
  return pixel;
}

/// What an observation's steepness counts for, as the own car may keep the sun from the point, or
/// the sky.
double GroundProjector::LitShare(const Eigen::Vector2d& point_in_ground) const {
  const double off = image_->contact.DistanceTo(point_in_ground);
  const double lit =
      kShadePenalty + (1 - kShadePenalty) * std::clamp((off - kOwnShade) / kShadeRim, 0.0, 1.0);
  const bool is_shaded = to_sun_in_ground_ && car_.Shades(point_in_ground, *to_sun_in_ground_);
  return is_shaded ? kInShade : lit;
}

GroundPixel GroundProjector::See(const Eigen::Vector3d& point_in_site) const {
  const Eigen::Vector3d& eye = image_->site_from_camera.translation;
  const Eigen::Vector3d observation = point_in_site - eye;
  if (observation.head<2>().squaredNorm() > max_range_ * max_range_ || observation.z() > -0.05)
    return {};
  if (!image_->open_ground.Shows(eye.head<2>(), point_in_site.head<2>())) return {};
  const Eigen::Vector3d point_in_ground = ground_from_site_ * point_in_site;
  const std::optional<Eigen::Vector2d> pixel = PixelOf(point_in_site, point_in_ground);
  if (!pixel) return {};
  const double lit = LitShare(point_in_ground.head<2>());
  return {pixel->cast<float>(), static_cast<float>(lit * -observation.z() / observation.norm())};
}

Eigen::Array3f FindGain(const GroundImage& image, const CellFinder& cells, double max_range) {
  constexpr int kNumAngles = 48, kNumRanges = 12;
  const GroundProjector projector(image, max_range);
  const Eigen::Vector3d& eye = image.site_from_camera.translation;
  std::array<std::vector<float>, 3> ratios;
  for (int i = 0; i < kNumAngles; ++i)
    for (int k = 1; k <= kNumRanges; ++k) {
      const double angle = 2 * std::numbers::pi * i / kNumAngles,
                   range = max_range * k / kNumRanges;
      Eigen::Vector3d point = eye + range * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      point.z() = image.site_from_ground.translation.z();
      const SurfaceCell* cell = cells.Find(point);
      if (cell == nullptr) continue;
      point.z() = static_cast<double>(cell->height);
      const std::optional<Eigen::Vector2d> pixel = projector.PixelOf(point);
      if (!pixel) continue;
      const Eigen::Vector2f place = pixel->cast<float>();
      const std::array<float, 3> color = ColorAt(image.image, place.x(), place.y());
      const int seen = Lightness(ToByte(color[0]), ToByte(color[1]), ToByte(color[2]));
      const int known = Lightness(cell->color[2], cell->color[1], cell->color[0]);
      if (seen <= 8 || seen >= 247 || known <= 8 || known >= 247) continue;
      for (size_t c = 0; c < 3; ++c)
        ratios[c].push_back(static_cast<float>(cell->color[2 - c]) / std::max(color[c], 1.0F));
    }
  Eigen::Array3f gain = Eigen::Array3f::Ones();
  if (ratios[0].size() < kMinGainSamples) return gain;
  for (size_t c = 0; c < 3; ++c) {
    gain[static_cast<Eigen::Index>(c)] =
        std::clamp(Median(std::move(ratios[c])), 1 / kMaxGain, kMaxGain);
  }
  return gain;
}

}  // namespace parkade
