#include "mapping/texture/light_meter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/image_sampling.h"
#include "mapping/texture/own_shade.h"

namespace parkade {
namespace {

constexpr double kNear = 4;  // [m] from the wheels' contact area: as far as most shadows reach
constexpr std::size_t kMinObservations = 3;    // of a place by one drive, to say what is dark there
constexpr int kDarkest = 8, kBrightest = 247;  // of luma that sensors tell apart
constexpr int kBlur = 2;  // [px] around: a place about as large as other images see it

/// The mean color of the pixels around one.
std::array<float, 3> ColorAround(const cv::Mat& image, const Eigen::Vector2f& pixel) {
  std::array<float, 3> sum{};
  for (int y = -kBlur; y <= kBlur; ++y)
    for (int x = -kBlur; x <= kBlur; ++x) {
      const std::array<float, 3> color = ColorAt(
          image,
          std::clamp(pixel.x() + static_cast<float>(x), 0.0F, static_cast<float>(image.cols - 1)),
          std::clamp(pixel.y() + static_cast<float>(y), 0.0F, static_cast<float>(image.rows - 1)));
      for (std::size_t c = 0; c < 3; ++c) sum[c] += color[c];
    }
  constexpr float kCount = (2 * kBlur + 1) * (2 * kBlur + 1);
  for (float& value : sum) value /= kCount;
  return sum;
}

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
  const GroundProjector projector(image, max_range_);
  const Eigen::Vector3d& eye = image.site_from_camera.translation;
  std::vector<std::pair<std::size_t, LightObservation>> observations;
  const auto begin = std::partition_point(points_.begin(), points_.end(), [&](const auto& point) {
    return point.x() < eye.x() - max_range_;
  });
  for (auto point = begin; point != points_.end() && point->x() <= eye.x() + max_range_; ++point) {
    const GroundPixel seen = projector.See(*point);
    if (seen.steepness <= 0) continue;
    const std::array<float, 3> color = ColorAround(image.image, seen.pixel);
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
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Rigid3 ground_from_site = images[i].site_from_ground.Inverse();
    for (const auto& [place, observation] : observations_of[i]) {
      places_[place].Add(observation);
      const Eigen::Vector3d at = ground_from_site * points_[place];
      if (images[i].contact.DistanceTo(at.head<2>()) < kNear)
        near_.push_back({place, observation.image, observation.log_color.mean()});
    }
  }
}

/// A place is as bright as the second brightest of the observations that count shows it: the
/// brightest may err, and what may be the own shade counts little.
void LightMeter::FindSuns(std::span<GroundImage* const> images,
                          const PhotometricCalibration& light) const {
  std::map<int, std::vector<float>> lit;  // by drive and place; NaN where unknown
  for (std::size_t i = 0; i < places_.size(); ++i) {
    std::map<int, std::vector<float>> brightness;  // by drive
    for (const LightObservation& observation : places_[i].observations())
      if (observation.weight > 0)
        brightness[images[observation.image]->drive].push_back(
            (observation.log_color + light.gains[observation.image].log()).mean());
    for (auto& [drive, seen] : brightness) {
      if (seen.size() < kMinObservations) continue;
      std::nth_element(seen.begin(), seen.begin() + 1, seen.end(), std::greater<>());
      lit.try_emplace(drive, places_.size(), std::numeric_limits<float>::quiet_NaN())
          .first->second[i] = seen[1];
    }
  }
  std::map<int, std::vector<ShadeSample>> samples;  // by drive
  for (const NearPlace& near : near_) {
    const GroundImage* image = images[near.image];
    const auto of_drive = lit.find(image->drive);
    if (of_drive == lit.end() || std::isnan(of_drive->second[near.place])) continue;
    const Rigid3 ground_from_site = image->site_from_ground.Inverse();
    samples[image->drive].push_back(
        {(ground_from_site * points_[near.place]).head<2>(),
         ground_from_site.rotation.toRotationMatrix(),
         of_drive->second[near.place] - (near.log_color + light.gains[near.image].log().mean())});
  }
  for (const auto& [drive, of_drive] : samples) {
    const auto first =
        std::find_if(images.begin(), images.end(),
                     [&, drive = drive](const auto* image) { return image->drive == drive; });
    const std::optional<Eigen::Vector3d> to_sun = FindSun(of_drive, (*first)->contact);
    for (GroundImage* image : images)
      if (image->drive == drive) image->to_sun = to_sun;
    LogInfo("stage=find_sun drive=" + std::to_string(drive) +
            " samples=" + std::to_string(of_drive.size()) +
            (to_sun ? " elevation=" + std::to_string(std::asin(to_sun->z())) : " none"));
  }
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
  FindSuns(images, light);
  LogInfo("stage=balance_light images=" + std::to_string(images.size()) +
          " disagreement=" + std::to_string(LightDisagreement(priors, places_, before)) + "->" +
          std::to_string(LightDisagreement(priors, places_, light)));
}

}  // namespace parkade
