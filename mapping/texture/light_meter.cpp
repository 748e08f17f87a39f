#include "mapping/texture/light_meter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/image_sampling.h"

namespace parkade {
namespace {

constexpr int kDarkest = 8, kBrightest = 247;  // of luma that sensors tell apart

}  // namespace

LightMeter::LightMeter(std::vector<Eigen::Vector3d> places, std::size_t num_photos, double max_range)
    : points_(std::move(places)), places_(points_.size()), photos_(num_photos), max_range_(max_range) {
  std::sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
}

std::vector<std::pair<std::size_t, LightSight>> LightMeter::SightsOf(const GroundPhoto& photo) const {
  const Rigid3 camera_from_site = photo.site_from_camera.Inverse();
  const Eigen::Vector3d& eye = photo.site_from_camera.translation;
  cv::Mat image;  // of which a pixel stands for a place about as large as others see it
  cv::blur(photo.image, image, {5, 5});
  std::vector<std::pair<std::size_t, LightSight>> sights;
  const auto begin = std::partition_point(points_.begin(), points_.end(),
                                          [&](const auto& point) { return point.x() < eye.x() - max_range_; });
  for (auto point = begin; point != points_.end() && point->x() <= eye.x() + max_range_; ++point) {
    const GroundSight seen = SeePoint(photo, camera_from_site, *point, max_range_);
    if (seen.steepness <= 0) continue;
    const std::array<float, 3> color = ColorAt(image, seen.pixel.x(), seen.pixel.y());
    const int luma = Lightness(static_cast<int>(color[0]), static_cast<int>(color[1]), static_cast<int>(color[2]));
    if (luma <= kDarkest || luma >= kBrightest) continue;
    LightSight sight{
        photo.index, seen.steepness, PhotoLight::SquaredRadius(seen.pixel, photo.image.cols, photo.image.rows), {}};
    for (int c = 0; c < 3; ++c) sight.log_color[c] = std::log(std::max(1.0F, color[static_cast<std::size_t>(c)]));
    sights.emplace_back(point - points_.begin(), sight);
  }
  return sights;
}

void LightMeter::Measure(std::span<const GroundPhoto> photos, const CellFinder& cells) {
  const auto sights_of = ParallelMap(photos.size(), [&](std::size_t i) {
    photos_[photos[i].index].log_gain = FindGain(photos[i], cells, max_range_).log();
    return SightsOf(photos[i]);
  });
  for (const auto& sights : sights_of)
    for (const auto& [place, sight] : sights) places_[place].Add(sight);
}

void LightMeter::Balance(std::span<GroundPhoto* const> photos) const {
  if (photos.empty()) return;
  std::vector<LightPrior> priors = photos_;
  std::map<const RigCamera*, std::uint32_t> lenses;
  for (const GroundPhoto* photo : photos)
    priors[photo->index].lens =
        lenses.try_emplace(photo->camera, static_cast<std::uint32_t>(lenses.size())).first->second;
  const BalancedLight light = BalanceLight(priors, places_);
  BalancedLight before{
      {}, std::vector<PhotoLight::Falloff>(lenses.size(), {Eigen::Array3f::Zero(), Eigen::Array3f::Zero()})};
  for (const LightPrior& prior : priors) before.gains.push_back(prior.log_gain.exp());
  for (GroundPhoto* photo : photos)
    photo->light = PhotoLight(light.gains[photo->index], light.falloffs[priors[photo->index].lens],
                              photo->camera->model.width(), photo->camera->model.height());
  LogInfo("stage=balance_light photos=" + std::to_string(photos.size()) +
          " disagreement=" + std::to_string(LightDisagreement(priors, places_, before)) + "->" +
          std::to_string(LightDisagreement(priors, places_, light)));
}

}  // namespace parkade
