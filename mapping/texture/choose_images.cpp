#include "mapping/texture/choose_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

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

class PlaceSquares {
 public:
  explicit PlaceSquares(std::span<const Eigen::Vector3d> points) {
    for (const Eigen::Vector3d& point : points)
      squares_[SquareOf(point.head<2>())].push_back({point, {}});
  }

  template <typename Visitor>
  void VisitAround(const Eigen::Vector2d& center, double radius, const Visitor& visit) {
    const auto [low_x, low_y] = SquareOf(center.array() - radius);
    const auto [high_x, high_y] = SquareOf(center.array() + radius);
    for (int x = low_x; x <= high_x; ++x)
      for (int y = low_y; y <= high_y; ++y)
        if (const auto found = squares_.find({x, y}); found != squares_.end())
          for (Place& place : found->second) visit(place);
  }

 private:
  static std::pair<int, int> SquareOf(const Eigen::Vector2d& point) {
    return {static_cast<int>(std::floor(point.x() / kSquare)),
            static_cast<int>(std::floor(point.y() / kSquare))};
  }
  std::map<std::pair<int, int>, std::vector<Place>> squares_;
};

}  // namespace

std::vector<bool> ChooseImages(std::span<GroundImage> images,
                               std::span<const Eigen::Vector3d> places, double max_range,
                               const std::optional<ObstacleChecks>& obstacles) {
  PlaceSquares squares(places);
  std::vector<bool> is_chosen(images.size());
  for (std::size_t i = images.size(); i-- > 0;) {
    GroundImage& image = images[i];
    const Rigid3 camera_from_site = image.site_from_camera.Inverse();
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
      const float steepness = SeePoint(image, camera_from_site, place.point, max_range).steepness;
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
