#include "mapping/texture/chart_painter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/ground/image_sampling.h"
#include "mapping/texture/fill_charts.h"

namespace parkade {
namespace {

constexpr float kLeastAbove =
    1;  // of the rank of an observation above the least: observations all alike weigh alike
constexpr double kMaxPixelGap =
    60;  // [px] between two corners of a block: more is a fold of the lens
constexpr float kSurelyLess = 0.85F;  // times the rank between two nodes: not among the best there
constexpr int kColorTolerance =
    24;  // of lightness: observations further from the median are something else

std::uint8_t RankOf(float steepness) {
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative, and lround is a call
  return static_cast<std::uint8_t>(1 + static_cast<int>(254 * steepness + 0.5F));
}

}  // namespace

ChartPainter::ChartPainter(BlankChart blank, double texel_size)
    : blank_(std::move(blank)), texel_size_(texel_size) {
  const cv::Mat& height = blank_.height;
  num_columns_ = (height.cols + kTexelsPerStep - 1) / kTexelsPerStep + 1;
  num_rows_ = (height.rows + kTexelsPerStep - 1) / kTexelsPerStep + 1;
  observations_.resize(static_cast<std::size_t>(height.rows) *
                       static_cast<std::size_t>(height.cols));
  corner_heights_.reserve(static_cast<std::size_t>(num_columns_) *
                          static_cast<std::size_t>(num_rows_));
  for (int row = 0; row < num_rows_; ++row)
    for (int column = 0; column < num_columns_; ++column) {
      float sum = 0;
      int count = 0;
      const int middle_x = column * kTexelsPerStep, middle_y = row * kTexelsPerStep;
      for (int y = std::max(0, middle_y - kTexelsPerStep);
           y < std::min(height.rows, middle_y + kTexelsPerStep); ++y)
        for (int x = std::max(0, middle_x - kTexelsPerStep);
             x < std::min(height.cols, middle_x + kTexelsPerStep); ++x)
          if (const float z = height.at<float>(y, x); !std::isnan(z)) sum += z, ++count;
      corner_heights_.push_back(count > 0 ? sum / static_cast<float>(count)
                                          : std::numeric_limits<float>::quiet_NaN());
    }
}

Eigen::Vector2d ChartPainter::PlaceOf(double column, double row) const {
  return {blank_.chart.left + column * texel_size_, blank_.chart.top - row * texel_size_};
}

std::optional<Eigen::Vector3d> ChartPainter::CornerAt(int column, int row) const {
  const float height = corner_heights_[BlockAt(column, row)];
  if (std::isnan(height)) return {};
  Eigen::Vector3d point;
  point << PlaceOf(column * kTexelsPerStep, row * kTexelsPerStep), static_cast<double>(height);
  return point;
}

GroundPixel ChartPainter::SeeCorner(const GroundProjector& projector, int column, int row) const {
  const std::optional<Eigen::Vector3d> point = CornerAt(column, row);
  return point ? projector.See(*point) : GroundPixel{};
}

void ChartPainter::BeginDrive(int drive) {
  if (drive_ == drive) return;
  drive_ = drive;
  is_shown_.assign(observations_.size(), false);
  least_ranks_.assign(corner_heights_.size(), 0);
}

/// At every kStepsPerNode-th corner, the ranks of the images that show it best, the best first; 0
/// where there are fewer.
cv::Mat_<cv::Vec4b> ChartPainter::BestRanks(std::span<const GroundImage* const> images,
                                            double max_range) const {
  static_assert(kNumObservations == 4);
  const auto num_nodes = [](int num_corners) { return (num_corners - 2) / kStepsPerNode + 2; };
  cv::Mat_<cv::Vec4b> best(num_nodes(num_rows_), num_nodes(num_columns_), cv::Vec4b());
  for (const GroundImage* image : images) {
    const GroundProjector projector(*image, max_range);
    const Part part = PartAround(image->site_from_camera.translation, max_range);
    const int right = std::min((part.column + part.width) / kStepsPerNode + 1, best.cols - 1),
              bottom = std::min((part.row + part.height) / kStepsPerNode + 1, best.rows - 1);
    for (int y = part.row / kStepsPerNode; y <= bottom; ++y)
      for (int x = part.column / kStepsPerNode; x <= right; ++x) {
        const float steepness = SeeCorner(projector, std::min(x * kStepsPerNode, num_columns_ - 1),
                                          std::min(y * kStepsPerNode, num_rows_ - 1))
                                    .steepness;
        if (steepness <= 0) continue;
        std::uint8_t rank = RankOf(steepness);
        for (int i = 0; i < 4; ++i)
          if (rank > best(y, x)[i]) std::swap(rank, best(y, x)[i]);
      }
  }
  return best;
}

void ChartPainter::Expect(std::span<const GroundImage* const> images, double max_range) {
  BeginDrive(images.front()->drive);
  const cv::Mat_<cv::Vec4b> best = BestRanks(images, max_range);
  for (int row = 0; row + 1 < num_rows_; ++row)
    for (int column = 0; column + 1 < num_columns_; ++column) {
      const int x = column / kStepsPerNode, y = row / kStepsPerNode;
      const int least =
          std::min({best(y, x)[3], best(y, x + 1)[3], best(y + 1, x)[3], best(y + 1, x + 1)[3]});
      least_ranks_[BlockAt(column, row)] =
          static_cast<std::uint8_t>(kSurelyLess * static_cast<float>(least));
    }
}

/// What earlier drives saw of a texel steps back once this one shows it.
void ChartPainter::StepBack(std::size_t texel) {
  if (is_shown_[texel]) return;
  is_shown_[texel] = true;
  observations_[texel].StepBack();
}

ChartPainter::Part ChartPainter::PartAround(const Eigen::Vector3d& eye, double max_range) const {
  const double step = kTexelsPerStep * texel_size_;
  const auto clamp_to = [](double value, int count) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(count - 1)));
  };
  const int left =
      clamp_to(std::floor((eye.x() - max_range - blank_.chart.left) / step), num_columns_);
  const int right =
      clamp_to(std::ceil((eye.x() + max_range - blank_.chart.left) / step), num_columns_);
  const int top = clamp_to(std::floor((blank_.chart.top - eye.y() - max_range) / step), num_rows_);
  const int bottom =
      clamp_to(std::ceil((blank_.chart.top - eye.y() + max_range) / step), num_rows_);
  return {left, top, right - left, bottom - top};
}

/// Most of a drive's observations are too flat to be kept by any texel of a block, and need not be
/// looked at: not even if nothing hid the ground.
cv::Mat1b ChartPainter::FindWanted(const Part& part, const Eigen::Vector3d& eye) const {
  const Eigen::Vector2d first =
      PlaceOf(part.column * kTexelsPerStep, part.row * kTexelsPerStep) - eye.head<2>();
  const double step = kTexelsPerStep * texel_size_;
  const auto num_corners = static_cast<std::size_t>(part.width) + 1;
  std::vector<float> off_x, upper(num_corners), lower(num_corners);
  for (int x = 0; x <= part.width; ++x) off_x.push_back(static_cast<float>(first.x() + x * step));
  cv::Mat1b is_wanted(part.height, part.width);
  for (int y = 0; y <= part.height; ++y) {
    std::swap(upper, lower);
    const auto off_y = static_cast<float>(first.y() - y * step);
    const float* heights = &corner_heights_[BlockAt(part.column, part.row + y)];
    for (std::size_t x = 0; x < num_corners; ++x) {
      const auto above = static_cast<float>(eye.z() - static_cast<double>(heights[x]));
      const float sine = above / std::sqrt(off_x[x] * off_x[x] + off_y * off_y + above * above);
      lower[x] = sine > 0 ? sine : 0;  // nor where no mesh is near
    }
    if (y == 0) continue;
    const std::uint8_t* least = &least_ranks_[BlockAt(part.column, part.row + y - 1)];
    std::uint8_t* wanted = is_wanted.ptr(y - 1);
    for (std::size_t x = 0; x + 1 < num_corners; ++x) {
      const float bound =
          std::min(std::min(upper[x], upper[x + 1]), std::min(lower[x], lower[x + 1]));
      wanted[x] = bound > 0 && RankOf(bound) > least[x];
    }
  }
  return is_wanted;
}

void ChartPainter::Paint(const GroundImage& image, double max_range) {
  const Eigen::Vector3d& eye = image.site_from_camera.translation;
  const Part part = PartAround(eye, max_range);
  if (part.width <= 0 || part.height <= 0) return;

  BeginDrive(image.drive);
  const GroundProjector projector(image, max_range);
  const cv::Mat1b is_wanted = FindWanted(part, eye);
  cv::Mat1b is_corner_wanted;  // of any of the four blocks around
  cv::copyMakeBorder(is_wanted, is_corner_wanted, 0, 1, 0, 1, cv::BORDER_CONSTANT, 0);
  cv::dilate(is_corner_wanted, is_corner_wanted, cv::Mat1b::ones(2, 2), {1, 1});
  std::vector<GroundPixel> above(static_cast<std::size_t>(part.width) + 1), below(above.size());
  for (int y = 0; y <= part.height; ++y) {
    std::swap(above, below);
    for (int x = 0; x <= part.width; ++x) {
      GroundPixel& observation = below[static_cast<std::size_t>(x)];
      observation = {};
      if (is_corner_wanted(y, x) != 0)
        observation = SeeCorner(projector, part.column + x, part.row + y);
    }
    if (y == 0) continue;
    for (int x = 0; x < part.width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      if (is_wanted(y - 1, x) != 0)
        PaintBlock(image, {above[i], above[i + 1], below[i], below[i + 1]}, part.column + x,
                   part.row + y - 1);
    }
  }
}

void ChartPainter::PaintBlock(const GroundImage& image, const std::array<GroundPixel, 4>& corners,
                              int column, int row) {
  float steepness = 1;
  for (const GroundPixel& corner : corners) {
    steepness = std::min(steepness, corner.steepness);
    if (static_cast<double>((corner.pixel - corners[0].pixel).norm()) > kMaxPixelGap) return;
  }
  if (steepness <= 0) return;
  const std::uint8_t rank = RankOf(steepness);
  std::uint8_t least = std::numeric_limits<std::uint8_t>::max();
  const int first_x = column * kTexelsPerStep, first_y = row * kTexelsPerStep;
  const int width = std::min(kTexelsPerStep, blank_.height.cols - first_x),
            height = std::min(kTexelsPerStep, blank_.height.rows - first_y);
  for (int dy = 0; dy < height; ++dy) {
    const float v = (static_cast<float>(dy) + 0.5F) / kTexelsPerStep;
    const Eigen::Vector2f left = (1 - v) * corners[0].pixel + v * corners[2].pixel,
                          right = (1 - v) * corners[1].pixel + v * corners[3].pixel;
    const std::uint8_t* mask = blank_.chart.mask.ptr(first_y + dy) + first_x;
    const std::size_t first =
        static_cast<std::size_t>(first_y + dy) * static_cast<std::size_t>(blank_.height.cols) +
        static_cast<std::size_t>(first_x);
    for (int dx = 0; dx < width; ++dx) {
      if (mask[dx] == 0) continue;
      const std::size_t texel = first + static_cast<std::size_t>(dx);
      StepBack(texel);
      Observations& observations = observations_[texel];
      if (!observations.Wants(rank)) {
        least = std::min(least, observations[kNumObservations - 1].rank);
        continue;
      }
      const float u = (static_cast<float>(dx) + 0.5F) / kTexelsPerStep;
      const Eigen::Vector2f pixel = (1 - u) * left + u * right;
      const std::array<float, 3> color = ColorAt(image.image, pixel.x(), pixel.y());
      const std::array<float, 3>& light = image.light.At(pixel);
      observations.Add({ToByte(light[0] * color[0]), ToByte(light[1] * color[1]),
                        ToByte(light[2] * color[2]), rank});
      least = std::min(least, observations[kNumObservations - 1].rank);
    }
  }
  std::uint8_t& least_rank = least_ranks_[BlockAt(column, row)];
  least_rank = std::max(least_rank, least);
}

std::array<std::uint8_t, 3> ChartPainter::Agree(const Observations& observations) {
  const std::size_t count = observations.CountComparable();
  std::array<int, kNumObservations> lightness{};
  for (std::size_t i = 0; i < count; ++i)
    lightness[i] = Lightness(observations[i].blue, observations[i].green, observations[i].red);
  std::array<int, kNumObservations> sorted = lightness;
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
  const int median = sorted[(count - 1) / 2];
  // Steep observations are sharp ones: they weigh most, and the rest only hides the seams, so that
  // one that comes to be kept or is no more weighs nothing at first.
  const float least = std::max(kComparable * static_cast<float>(observations[0].rank),
                               static_cast<float>(observations[kNumObservations - 1].rank));
  std::array<float, 3> sum{};
  float total = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(lightness[i] - median) > kColorTolerance) continue;
    const float above =
        std::max(static_cast<float>(observations[i].rank) - least, 0.0F) + kLeastAbove;
    const float weight = above * above;
    sum[0] += weight * static_cast<float>(observations[i].blue);
    sum[1] += weight * static_cast<float>(observations[i].green);
    sum[2] += weight * static_cast<float>(observations[i].red);
    total += weight;
  }
  return {ToByte(sum[0] / total), ToByte(sum[1] / total), ToByte(sum[2] / total)};
}

TextureChart ChartPainter::Finish(const CellFinder& cells) {
  TextureChart& chart = blank_.chart;
  for (int row = 0; row < chart.image.rows; ++row)
    for (int column = 0; column < chart.image.cols; ++column) {
      std::uint8_t& mask = chart.mask.at<std::uint8_t>(row, column);
      if (mask == 0) continue;
      const Observations& observations =
          observations_[static_cast<std::size_t>(row) * static_cast<std::size_t>(chart.image.cols) +
                        static_cast<std::size_t>(column)];
      cv::Vec3b& texel = chart.image.at<cv::Vec3b>(row, column);
      if (!observations.empty()) {
        const auto [blue, green, red] = Agree(observations);
        texel = {blue, green, red};
        mask = TextureChart::kPainted;
        continue;
      }
      Eigen::Vector3d point;
      point << PlaceOf(column + 0.5, row + 0.5),
          static_cast<double>(blank_.height.at<float>(row, column));
      if (const SurfaceCell* cell = cells.Find(point))
        texel = {cell->color[2], cell->color[1], cell->color[0]};
    }
  SmoothPlain(chart, texel_size_);
  ContinueBeyondBorder(chart);
  return std::move(chart);
}

}  // namespace parkade
