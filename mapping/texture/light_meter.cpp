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

LightMeter::LightMeter(std::vector<Eigen::Vector3d> places, std::size_t num_images,
                       double max_range)
    : points_(std::move(places)),
      places_(points_.size()),
      images_(num_images),
      max_range_(max_range) {
  std::sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
}

std::vector<std::pair<std::size_t, LightObservation>> LightMeter::ObservationsOf(
    const GroundImage& image) const {
  const Rigid3 camera_from_site = image.site_from_camera.Inverse();
  const Eigen::Vector3d& eye = image.site_from_camera.translation;
  cv::Mat blurred;  // of which a pixel stands for a place about as large as others see it
  cv::blur(image.image, blurred, {5, 5});
  std::vector<std::pair<std::size_t, LightObservation>> observations;
  const auto begin = std::partition_point(points_.begin(), points_.end(), [&](const auto& point) {
    return point.x() < eye.x() - max_range_;
  });
  for (auto point = begin; point != points_.end() && point->x() <= eye.x() + max_range_; ++point) {
    const GroundPixel seen = SeePoint(image, camera_from_site, *point, max_range_);
    if (seen.steepness <= 0) continue;
    const std::array<float, 3> color = ColorAt(blurred, seen.pixel.x(), seen.pixel.y());
    const int luma = Lightness(static_cast<int>(color[0]), static_cast<int>(color[1]),
                               static_cast<int>(color[2]));
    if (luma <= kDarkest || luma >= kBrightest) continue;
    LightObservation observation{
        image.index,
        seen.steepness,
        ExposureAndVignetting::SquaredRadius(seen.pixel, image.image.cols, image.image.rows),
        {}};
    for (int c = 0; c < 3; ++c)
      observation.log_color[c] = std::log(std::max(1.0F, color[static_cast<std::size_t>(c)]));
    observations.emplace_back(point - points_.begin(), observation);
  }
  return observations;
}

void LightMeter::Measure(std::span<const GroundImage> images, const CellFinder& cells) {
  const auto observations_of = ParallelMap(images.size(), [&](std::size_t i) {
    images_[images[i].index].log_gain = FindGain(images[i], cells, max_range_).log();
    return ObservationsOf(images[i]);
  });
  for (const auto& observations : observations_of)
    for (const auto& [place, observation] : observations) places_[place].Add(observation);
}

void LightMeter::Balance(std::span<GroundImage* const> images) const {
  if (images.empty()) return;
  std::vector<LightPrior> priors = images_;
  std::map<const RigCamera*, std::uint32_t> lenses;
  for (const GroundImage* image : images)
    priors[image->index].lens =
        lenses.try_emplace(image->camera, static_cast<std::uint32_t>(lenses.size())).first->second;
  const PhotometricCalibration light = CalibratePhotometry(priors, places_);
  PhotometricCalibration before{
      {},
      std::vector<ExposureAndVignetting::Falloff>(
          lenses.size(), {Eigen::Array3f::Zero(), Eigen::Array3f::Zero()})};
  for (const LightPrior& prior : priors) before.gains.push_back(prior.log_gain.exp());
  for (GroundImage* image : images)
    image->light =
        ExposureAndVignetting(light.gains[image->index], light.falloffs[priors[image->index].lens],
                              image->camera->model.width(), image->camera->model.height());
  LogInfo("stage=balance_light images=" + std::to_string(images.size()) +
          " disagreement=" + std::to_string(LightDisagreement(priors, places_, before)) + "->" +
          std::to_string(LightDisagreement(priors, places_, light)));
}

}  // namespace parkade
