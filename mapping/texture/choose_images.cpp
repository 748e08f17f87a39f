#include "mapping/texture/choose_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mapping/ground/square_index.h"

namespace parkade {
namespace {

constexpr double kSquare = 4.0;      // [m] of the squares in which places are sorted
constexpr int kNumObservations = 4;  // of a place that are wanted, as many as are painted from
constexpr float kClearly = 1.15F;    // times as steep as the best
constexpr int kMinPlaces = 3;        // that an image must serve

/// A place and how steeply it is seen by the images chosen so far, the steepest first.
struct Place {
  Eigen::Vector3d point;  ///< [m] in site
  std::array<float, kNumObservations> observations{};
  int drive = 0;    ///< the earliest that shows it
  float worth = 1;  ///< of that one's observations

  float WorthOf(int of_drive) const {
    return of_drive == drive || observations.front() == 0 ? worth : kEarlierShare * worth;
  }

  bool Wants(int of_drive, float steepness) const {
    const float worthy = WorthOf(of_drive) * steepness,
                comparable = kComparable * observations.front();
    return worthy > kClearly * observations.front() ||
           (observations.back() < comparable && worthy >= comparable);
  }

  void Add(int of_drive, float steepness) {
    worth = WorthOf(of_drive);
    drive = of_drive;
    if (worth * steepness <= observations.back()) return;
    observations.back() = worth * steepness;
    std::sort(observations.begin(), observations.end(), std::greater<>());
  }
};

}  // namespace

std::vector<bool> ChooseImages(std::span<GroundImage> images,
                               std::span<const Eigen::Vector3d> places, double max_range,
                               const std::optional<ObstacleChecks>& obstacles) {
  SquareIndex<Place> squares(kSquare);
  for (const Eigen::Vector3d& point : places) squares.Add(point.head<2>(), {point, {}});
  std::vector<bool> is_chosen(images.size());
  for (std::size_t i = images.size(); i-- > 0;) {
    GroundImage& image = images[i];
    const GroundProjector projector(image, max_range);
    const Eigen::Vector3d& eye = image.site_from_camera.translation;
    // What costs least comes first: how steep an observation can be at all, then the projection,
    // then what is in the way.
    std::vector<std::pair<Place*, float>> shown;
    const auto count_served = [&] {
      return std::count_if(shown.begin(), shown.end(), [&](const auto& observation) {
        return observation.first->Wants(image.drive, observation.second);
      });
    };
    squares.VisitAround(eye.head<2>(), max_range, [&](Place& place) {
      const Eigen::Vector3d observation = place.point - eye;
      if (!place.Wants(image.drive, static_cast<float>(-observation.z() / observation.norm())))
        return;
      const float steepness = projector.See(place.point).steepness;
      if (steepness > 0) shown.emplace_back(&place, steepness);
    });
    if (count_served() < kMinPlaces) continue;
    if (obstacles) {
      std::erase_if(shown, [&](const auto& observation) {
        return !obstacles->may_show(i, observation.first->point.template head<2>());
      });
      if (count_served() < kMinPlaces) continue;
      obstacles->prepare(i);
      std::erase_if(shown, [&](const auto& observation) {
        return !image.open_ground.Shows(eye.head<2>(), observation.first->point.template head<2>());
      });
      if (count_served() < kMinPlaces) continue;
    }
    is_chosen[i] = true;
    for (const auto& [place, steepness] : shown) place->Add(image.drive, steepness);
  }
  return is_chosen;
}

}  // namespace parkade
