#include "tests/bench/ground/ground_images.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "mapping/evaluation/height_raster.h"

namespace parkade {
namespace {

constexpr double kPixel = 0.05;     // [m]
constexpr double kReach = 12;       // [m] from the path
constexpr double kMaxGap = 0.5;     // [m] of height between what is compared
constexpr double kFullColor = 0.1;  // [m] of error

/// An image of what lies around a path.
class Image {
 public:
  Image(const std::vector<Eigen::Vector3d>& path, const cv::Vec3b& background) {
    Eigen::Vector2d low = path.front().head<2>(), high = low;
    for (const Eigen::Vector3d& point : path) {
      low = low.cwiseMin(point.head<2>());
      high = high.cwiseMax(point.head<2>());
    }
    corner_ = ((low.array() - kReach - 1) / kPixel).floor().matrix().cast<int>();
    const Eigen::Vector2i size =
        ((high - low).array() / kPixel + 2 * (kReach + 1) / kPixel).ceil().matrix().cast<int>();
    pixels_ = cv::Mat(size.y(), size.x(), CV_8UC3,
                      cv::Scalar(background[0], background[1], background[2]));
  }

  void Set(const HeightRaster::Sample& sample, const cv::Vec3b& color) {
    const int x = sample.x - corner_.x(), y = pixels_.rows - 1 - (sample.y - corner_.y());
    if (x >= 0 && y >= 0 && x < pixels_.cols && y < pixels_.rows)
      pixels_.at<cv::Vec3b>(y, x) = color;
  }

  void Write(const std::filesystem::path& file) const { cv::imwrite(file.string(), pixels_); }

 private:
  Eigen::Vector2i corner_;
  cv::Mat pixels_;
};

cv::Vec3b ColorOf(double error) {
  const double share = std::min(1.0, std::abs(error) / kFullColor);
  const auto rest = static_cast<uchar>(std::lround(200 * (1 - share)));
  const auto full = static_cast<uchar>(std::lround(200 + 55 * share));
  return error > 0 ? cv::Vec3b(rest, rest, full) : cv::Vec3b(full, rest, rest);
}

}  // namespace

void WriteOutlineImage(const TriangleMesh& truth_mesh, const TriangleMesh& estimate_mesh,
                       const std::vector<Eigen::Vector3d>& path, const SurfaceScope& scope,
                       const std::filesystem::path& file) {
  const HeightRaster truth(truth_mesh, kPixel, 0.1), estimate(estimate_mesh, kPixel, 0.1);
  Image image(path, {255, 255, 255});
  const std::vector<bool> is_truth_near = truth.FindNear(path, kReach);
  std::vector<Eigen::Vector3d> points;
  for (const HeightRaster::Sample& sample : truth.samples())
    points.push_back(truth.PointOf(sample));
  const std::vector<bool> is_seen = scope.find_seen(points);
  for (size_t i = 0; i < truth.samples().size(); ++i) {
    if (!is_truth_near[i]) continue;
    const HeightRaster::Sample& sample = truth.samples()[i];
    const bool is_found = estimate.Find(sample.x, sample.y, sample.height, kMaxGap) >= 0;
    image.Set(sample, is_found     ? cv::Vec3b(190, 190, 190)
                      : is_seen[i] ? cv::Vec3b(220, 80, 0)
                                   : cv::Vec3b(90, 90, 90));
  }
  const std::vector<bool> is_near = estimate.FindNear(path, kReach);
  for (size_t i = 0; i < estimate.samples().size(); ++i) {
    const HeightRaster::Sample& sample = estimate.samples()[i];
    if (is_near[i] && truth.Find(sample.x, sample.y, sample.height, kMaxGap) < 0)
      image.Set(sample, {0, 0, 230});
  }
  image.Write(file);
}

void WriteHeightImage(const TriangleMesh& truth_mesh, const TriangleMesh& estimate_mesh,
                      const std::vector<Eigen::Vector3d>& path, const std::filesystem::path& file) {
  const HeightRaster truth(truth_mesh, kPixel, 0.1), estimate(estimate_mesh, kPixel, 0.1);
  Image image(path, {0, 0, 0});
  for (const HeightRaster::Sample& sample : estimate.samples()) {
    const int found = truth.Find(sample.x, sample.y, sample.height, kMaxGap);
    if (found >= 0)
      image.Set(sample,
                ColorOf(sample.height - truth.samples()[static_cast<size_t>(found)].height));
  }
  for (const Eigen::Vector3d& point : path)
    image.Set({static_cast<int>(std::floor(point.x() / kPixel)),
               static_cast<int>(std::floor(point.y() / kPixel)), 0},
              {0, 160, 0});
  image.Write(file);
}

}  // namespace parkade
