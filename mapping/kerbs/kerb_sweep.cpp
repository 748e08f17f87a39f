#include "mapping/kerbs/kerb_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "core/parallel.h"
#include "mapping/kerbs/samples_around.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBlock = 24.0;  // [m] side of squares of the site whose strips are swept at once
constexpr std::size_t kMaxViews = 60;  // of a strip: the nearest ...
constexpr int kMaxDrives = 3;          // ... of the latest drives that look at it
constexpr double kMinEyeHeight = 0.3;  // [m] above the ground
constexpr double kMaxEyeHeight = 2.5;  // [m]; higher ones are on another deck
constexpr double kMinAway = 0.3;    // [m] of the camera from the outline, on the side of the ground
constexpr double kSharp = 3.0;      // [m] of distance from which views blur
constexpr float kMaxContrast = 25;  // [gray values] off the mean of a view
constexpr int kMinSamples = 8;      // of a view in a strip: fewer have no mean

/// A sample where its ray meets the strip's plane at height 0, and how it moves when the strip
/// rises.
struct ObservedPoint {
  float along = 0, outward = 0;              ///< [m]
  float along_shift = 0, outward_shift = 0;  ///< [m] per meter of height
  float gray = 0, weight = 0;
};

/// What one view shows of one strip.
struct View {
  int drive = 0;
  std::vector<ObservedPoint> points = {};
};

/// What a camera looks at from one place.
struct Seen {
  std::size_t patch = 0;
  double distance = 0;  ///< [m]
};

/// Which views look at a strip, the nearest first. What it costs is not to grow with the number of
/// drives.
std::vector<Seen> FindViews(const OutlineStrip& strip, std::span<const PatchView> views,
                            std::span<const Vector3d> eyes) {
  std::vector<Seen> seen;
  int num_drives = 0;
  for (std::size_t i = views.size(); i-- > 0;) {
    const Vector3d to_eye = eyes[i] - strip.foot;
    const double distance = to_eye.head<2>().norm();
    if (distance > kMaxKerbDistance || to_eye.z() < kMinEyeHeight || to_eye.z() > kMaxEyeHeight)
      continue;
    if (-to_eye.head<2>().dot(strip.Outward()) < kMinAway) continue;
    if (views[i].extent.exteriorDistance(strip.foot.head<2>().eval()) > 0) continue;
    const bool is_of_another = seen.empty() || views[seen.back().patch].drive != views[i].drive;
    if (is_of_another && ++num_drives > kMaxDrives) break;
    seen.push_back({i, distance});
  }
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return std::tie(a.distance, a.patch) < std::tie(b.distance, b.patch);
  });
  if (seen.size() > kMaxViews) seen.resize(kMaxViews);
  return seen;
}

/// Heights of a sweep; none where the lowest exceeds the highest.
struct Heights {
  double lowest = 0, highest = 0;  ///< [m]

  /// Those at which a coordinate that is `at` [m] at height 0 and falls by `per_meter` lies between
  /// two bounds.
  Heights Within(double at, double per_meter, double from, double to) const {
    if (std::abs(per_meter) < 1e-9) return at >= from && at <= to ? *this : Heights{1, 0};
    const double a = (at - from) / per_meter, b = (at - to) / per_meter;
    return {std::max(lowest, std::min(a, b)), std::min(highest, std::max(a, b))};
  }
};

/// The ground of a strip within a window.
GroundArea AreaOf(const OutlineStrip& strip, double length, const StripWindow& window) {
  const Vector2d outward = strip.Outward();
  GroundArea corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = strip.foot.head<2>() + (i % 2 == 0 ? -0.5 : 0.5) * length * strip.along +
                 (i < 2 ? window.begin : window.End()) * outward;
  return corners;
}

/// The samples of a patch that show a strip at some height of the sweep.
std::vector<ObservedPoint> LookAt(const OutlineStrip& strip, double length,
                                  const SamplesAround& samples, const Vector3d& eye,
                                  const StripWindow& window) {
  std::vector<ObservedPoint> points;
  const Vector2d outward = strip.Outward();
  const Vector3d eye_in_strip((eye - strip.foot).head<2>().dot(strip.along),
                              (eye - strip.foot).head<2>().dot(outward), eye.z() - strip.foot.z());
  const Vector2d slope(strip.slope, strip.slope_outward);
  const double above =
      eye_in_strip.z() - slope.dot(eye_in_strip.head<2>());  // the strip's plane, continued
  const auto look = [&](const Eigen::Vector3f& ray_in_site, float gray) {
    const Vector2d flat = ray_in_site.head<2>().cast<double>();
    const Vector3d ray(flat.dot(strip.along), flat.dot(outward),
                       static_cast<double>(ray_in_site.z()));
    const double descent = slope.dot(ray.head<2>()) - ray.z();  // toward the plane, per ray
    if (descent < 0.05 * ray.norm()) return;
    const Vector2d per_meter = ray.head<2>() / descent;
    const Vector2d place = eye_in_strip.head<2>() + above * per_meter;
    Heights heights{window.min_height, window.max_height};
    heights = heights.Within(place.y(), per_meter.y(), window.begin, window.End());
    heights = heights.Within(place.x(), per_meter.x(), -0.5 * length, 0.5 * length);
    if (heights.lowest > heights.highest) return;
    const double distance = above * per_meter.norm();
    points.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()),
                      static_cast<float>(-per_meter.x()), static_cast<float>(-per_meter.y()), gray,
                      static_cast<float>(1 / (1 + distance * distance / (kSharp * kSharp)))});
  };
  samples.VisitBehind(AreaOf(strip, length, window), look);
  return points;
}

/// Weighted sums over samples.
struct Sums {
  float weight = 0, gray = 0, square = 0;
  int count = 0;

  void Add(float value, float of_weight) {
    weight += of_weight;
    gray += of_weight * value;
    square += of_weight * value * value;
    ++count;
  }
  void Add(const Sums& other) {
    weight += other.weight, gray += other.gray, square += other.square;
    count += other.count;
  }
  float Residual() const { return weight > 0 ? std::max(0.0F, square - gray * gray / weight) : 0; }
};

/// The image of one strip at one height.
class StripImage {
 public:
  StripImage(double length, const StripWindow& window)
      : half_length_(static_cast<float>(0.5 * length)),
        begin_(static_cast<float>(window.begin)),
        columns_(static_cast<int>(std::lround(length / StripWindow::kCellSize))),
        cells_(static_cast<std::size_t>(columns_ * kRows)) {}

  void Draw(double height, std::span<const View> views) {
    hits_.clear();
    for (const View& view : views) Add(view, static_cast<float>(height));
    // An edge along the outline that crosses cells would look like views that disagree there.
    std::fill(profile_.begin(), profile_.end(), Sums{});
    for (const Hit& hit : hits_) profile_[hit.line].Add(hit.gray, hit.weight);
    std::fill(cells_.begin(), cells_.end(), Sums{});
    for (const Hit& hit : hits_) {
      const Sums& line = profile_[hit.line];
      cells_[hit.cell].Add(hit.gray - line.gray / line.weight, hit.weight);
    }
  }

  Agreement OfRows(int begin, int end) const {
    Agreement agreement;
    for (int row = begin; row < end; ++row) {
      Sums of_row;
      for (int column = 0; column < columns_; ++column) {
        const Sums& cell = cells_[static_cast<std::size_t>(row * columns_ + column)];
        if (cell.count == 0) continue;
        agreement.residual += cell.Residual();
        ++agreement.num_cells;
        of_row.Add(cell);
      }
      if (of_row.count == 0) continue;
      agreement.total += of_row.Residual();
      agreement.weight += of_row.weight;
      agreement.num_samples += of_row.count;
      ++agreement.num_means;
    }
    return agreement;
  }

 private:
  static constexpr int kRows = StripWindow::kNearRows + StripWindow::kFarRows;
  static constexpr int kLinesPerRow = 5;

  /// A sample in the image: its cell, and the thin line along the outline that it lies on.
  struct Hit {
    std::size_t cell = 0, line = 0;
    float gray = 0, weight = 0;  ///< gray off the mean of its view
  };

  void Add(const View& view, float height) {
    constexpr auto kPerCell = static_cast<float>(1 / StripWindow::kCellSize);
    const std::size_t first = hits_.size();
    Sums of_view;
    for (const ObservedPoint& observation : view.points) {
      const float x =
          kPerCell * (observation.along + height * observation.along_shift + half_length_);
      const float y =
          kPerCell * (observation.outward + height * observation.outward_shift - begin_);
      if (x < 0 || y < 0) continue;
      const int column = static_cast<int>(x), row = static_cast<int>(y);
      if (column >= columns_ || row >= kRows) continue;
      hits_.push_back({static_cast<std::size_t>(row * columns_ + column),
                       std::min(static_cast<std::size_t>(y * kLinesPerRow), profile_.size() - 1),
                       observation.gray, observation.weight});
      of_view.Add(observation.gray, observation.weight);
    }
    if (of_view.count < kMinSamples) {
      hits_.resize(first);
      return;
    }
    const float mean = of_view.gray / of_view.weight;
    for (std::size_t i = first; i < hits_.size(); ++i)
      hits_[i].gray = std::clamp(hits_[i].gray - mean, -kMaxContrast, kMaxContrast);
  }

  float half_length_, begin_;
  int columns_;
  std::vector<Sums> cells_;
  std::array<Sums, kRows * kLinesPerRow> profile_;
  std::vector<Hit> hits_;
};

/// The views of each drive that has two, in order of the drives; those of a drive stand together.
std::vector<std::span<const View>> ByDrive(std::span<const View> views) {
  std::vector<std::span<const View>> drives;
  for (std::size_t begin = 0, end = 0; begin < views.size(); begin = end) {
    while (end < views.size() && views[end].drive == views[begin].drive) ++end;
    if (end - begin > 1) drives.push_back(views.subspan(begin, end - begin));
  }
  return drives;
}

/// The sum over the views of a drive of how far their shifts along the strip are off their mean,
/// squared.
double SquaredParallaxOf(std::span<const View> views) {
  double sum = 0, square = 0;
  for (const View& view : views) {
    double shift = 0;
    for (const ObservedPoint& point : view.points) shift += static_cast<double>(point.along_shift);
    shift /= static_cast<double>(view.points.size());
    sum += shift, square += shift * shift;
  }
  return std::max(0.0, square - sum * sum / static_cast<double>(views.size()));
}

SweptStrip Sweep(std::span<const View> views, double length, const StripWindow& window) {
  SweptStrip swept;
  const auto num_heights = static_cast<std::size_t>(window.NumHeights());
  double squared_parallax = 0;
  StripImage image(length, window);
  for (const std::span<const View> of_drive : ByDrive(views)) {
    swept.num_views += static_cast<int>(of_drive.size());
    squared_parallax += SquaredParallaxOf(of_drive);
    swept.near_outline.resize(num_heights);
    swept.far_off.resize(num_heights);
    for (std::size_t i = 0; i < num_heights; ++i) {
      image.Draw(window.HeightAt(static_cast<double>(i)), of_drive);
      swept.near_outline[i].Add(image.OfRows(0, StripWindow::kNearRows));
      swept.far_off[i].Add(
          image.OfRows(StripWindow::kNearRows, StripWindow::kNearRows + StripWindow::kFarRows));
    }
  }
  if (swept.num_views > 0) swept.parallax = std::sqrt(squared_parallax / swept.num_views);
  return swept;
}

/// Strips by square of the site: those of one read the same patches.
std::vector<std::vector<std::size_t>> MakeBlocks(std::span<const OutlineStrip> strips) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> blocks;
  for (std::size_t i = 0; i < strips.size(); ++i)
    blocks[{static_cast<int>(std::floor(strips[i].foot.y() / kBlock)),
            static_cast<int>(std::floor(strips[i].foot.x() / kBlock))}]
        .push_back(i);
  std::vector<std::vector<std::size_t>> list;
  list.reserve(blocks.size());
  for (auto& [index, block] : blocks) list.push_back(std::move(block));
  return list;
}

/// [m] in site: where each view was taken from; nowhere near where that is not known.
std::vector<Vector3d> FindEyes(std::span<const PatchView> views,
                               std::span<const DrivenPath> paths) {
  std::vector<Vector3d> eyes;
  for (const PatchView& view : views) {
    const DrivenPath* path = FindPath(paths, view.drive);
    const auto camera = static_cast<std::size_t>(view.camera);
    const bool is_known = path != nullptr && camera < path->cameras_in_body.size();
    eyes.push_back(is_known ? view.site_from_body * path->cameras_in_body[camera]
                            : Vector3d::Constant(1e9));
  }
  return eyes;
}

}  // namespace

int StripWindow::NumHeights() const {
  return 1 + static_cast<int>(std::lround((max_height - min_height) / kHeightStep));
}

std::vector<std::vector<SweptStrip>> SweepStrips(std::span<const OutlineStrip> strips,
                                                 double length, const PatchSource& patches,
                                                 std::span<const DrivenPath> paths,
                                                 std::span<const StripWindow> windows) {
  const std::vector<Vector3d> eyes = FindEyes(patches.views(), paths);
  const auto seen = ParallelMap(
      strips.size(), [&](std::size_t i) { return FindViews(strips[i], patches.views(), eyes); });
  std::vector<std::vector<SweptStrip>> swept(windows.size(),
                                             std::vector<SweptStrip>(strips.size()));
  for (const std::vector<std::size_t>& block : MakeBlocks(strips)) {
    std::map<std::size_t, std::vector<std::size_t>> strips_of;  // by patch
    for (const std::size_t strip : block)
      for (const Seen& view : seen[strip]) strips_of[view.patch].push_back(strip);
    const std::vector<std::pair<std::size_t, std::vector<std::size_t>>> list(strips_of.begin(),
                                                                             strips_of.end());
    auto looks = ParallelMap(list.size(), [&](std::size_t k) {
      const Vector3d& eye = eyes[list[k].first];
      std::vector<GroundArea> areas;
      for (const StripWindow& window : windows)
        for (const std::size_t strip : list[k].second)
          areas.push_back(AreaOf(strips[strip], length, window));
      const SamplesAround samples(patches.Read(list[k].first), eye, areas);
      const int drive = patches.views()[list[k].first].drive;
      std::vector<View> of_strips;  // window by window
      for (const StripWindow& window : windows)
        for (const std::size_t strip : list[k].second)
          of_strips.push_back({drive, LookAt(strips[strip], length, samples, eye, window)});
      return of_strips;
    });
    for (std::size_t w = 0; w < windows.size(); ++w) {
      std::map<std::size_t, std::vector<View>> views_of;  // by strip
      for (std::size_t k = 0; k < list.size(); ++k)
        for (std::size_t i = 0; i < list[k].second.size(); ++i) {
          View& view = looks[k][w * list[k].second.size() + i];
          if (!view.points.empty()) views_of[list[k].second[i]].push_back(std::move(view));
        }
      ParallelFor(block.size(), [&](std::size_t i) {
        const auto found = views_of.find(block[i]);
        if (found != views_of.end()) swept[w][block[i]] = Sweep(found->second, length, windows[w]);
      });
    }
  }
  return swept;
}

}  // namespace parkade
