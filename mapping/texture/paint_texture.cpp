#include "mapping/texture/paint_texture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/texture/chart_painter.h"
#include "mapping/texture/choose_images.h"
#include "mapping/texture/image_reader.h"
#include "mapping/texture/light_meter.h"

namespace parkade {
namespace {

constexpr double kPlaceDistance = 0.5;       // [m] between places that images are chosen for ...
constexpr double kLightPlaceDistance = 1.0;  // ... and at which their light is compared

const TextureSource* FindSource(std::span<const TextureSource> sources, int drive) {
  const auto found = std::find_if(sources.begin(), sources.end(), [&](const TextureSource& source) {
    return source.path->drive == drive;
  });
  return found == sources.end() ? nullptr : &*found;
}

/// An image that is yet to be read.
GroundImage ImageOf(const PatchView& view, const TextureSource& source) {
  const RigCamera& camera = source.log->rig().cameras[static_cast<std::size_t>(view.camera)];
  return {.image = {},
          .camera = &camera,
          .site_from_camera = view.site_from_body * camera.body_from_camera,
          .site_from_ground = view.site_from_body * source.path->body_from_ground,
          .contact = source.path->contact,
          .drive = view.drive};
}

/// Places on the mesh, evenly spread.
std::vector<Eigen::Vector3d> PlacesOn(const std::vector<ChartSquare>& squares,
                                      const TriangleMesh& mesh, double distance) {
  const auto of_squares = ParallelMap(squares.size(), [&](std::size_t i) {
    std::vector<Eigen::Vector3d> places;
    for (const BlankChart& blank : ChartsOf(squares[i], mesh, distance))
      for (int row = 0; row < blank.height.rows; ++row)
        for (int column = 0; column < blank.height.cols; ++column)
          if (const float height = blank.height.at<float>(row, column); !std::isnan(height))
            places.emplace_back(blank.chart.left + (column + 0.5) * distance,
                                blank.chart.top - (row + 0.5) * distance, height);
    return places;
  });
  std::vector<Eigen::Vector3d> all;
  for (const auto& places : of_squares) all.insert(all.end(), places.begin(), places.end());
  return all;
}

/// The charts of one square: nothing but triangles until the first image comes, images after the
/// last.
class SquarePainter {
 public:
  SquarePainter(ChartSquare square, const TriangleMesh& mesh, const TextureOptions& options)
      : square_(std::move(square)), mesh_(&mesh), options_(&options) {
    for (const std::uint32_t triangle : square_.triangles)
      for (const std::uint32_t vertex : mesh.triangles[triangle])
        box_.extend((mesh.origin + mesh.vertices[vertex].cast<double>()).head<2>());
  }

  int column() const { return square_.column; }
  int row() const { return square_.row; }

  /// About how many texels its charts will have.
  double NumTexels() const {
    return (box_.sizes().array() / options_->texel_size + 2).prod();  // and a margin of one around
  }

  bool IsInReach(const GroundImage& image) const {
    return box_.exteriorDistance(image.site_from_camera.translation.head<2>().eval()) <=
           options_->max_range;
  }

  /// \param image  is read until its drive is painted
  void ExpectImage(const GroundImage& image) {
    expected_[image.drive].push_back(&image);
    ++num_to_come_;
  }

  void Paint(const GroundImage& image) {
    Begin();
    if (const auto of_drive = expected_.find(image.drive); of_drive != expected_.end()) {
      for (ChartPainter& painter : painters_) painter.Expect(of_drive->second, options_->max_range);
      expected_.erase(of_drive);
    }
    for (ChartPainter& painter : painters_) painter.Paint(image, options_->max_range);
    --num_to_come_;
  }

  /// Nothing more is to come and the images are not made yet.
  bool IsReady() const { return num_to_come_ == 0 && charts_.empty(); }

  void Finish(const CellFinder& cells) {
    Begin();
    for (ChartPainter& painter : painters_) charts_.push_back(painter.Finish(cells));
    painters_ = {};
  }

  std::vector<TextureChart>& charts() { return charts_; }

 private:
  void Begin() {
    if (!painters_.empty()) return;
    for (BlankChart& blank : ChartsOf(square_, *mesh_, options_->texel_size))
      painters_.emplace_back(std::move(blank), options_->texel_size);
  }

  ChartSquare square_;
  const TriangleMesh* mesh_;
  const TextureOptions* options_;
  Eigen::AlignedBox2d box_;                                  // [m] in site
  std::map<int, std::vector<const GroundImage*>> expected_;  // by drive that has not come yet
  int num_to_come_ = 0;
  std::vector<ChartPainter> painters_;
  std::vector<TextureChart> charts_;
};

void FinishReady(std::span<SquarePainter> painters, const CellFinder& cells) {
  std::vector<SquarePainter*> ready;
  for (SquarePainter& painter : painters)
    if (painter.IsReady()) ready.push_back(&painter);
  ParallelFor(ready.size(), [&](std::size_t i) { ready[i]->Finish(cells); });
}

void PaintDrive(const DriveLog& log, const ImageChoice& choice, const CellFinder& cells,
                std::span<SquarePainter> painters) {
  ImageReader reader(log, choice);
  for (std::vector<GroundImage> images = reader.Next(); !images.empty(); images = reader.Next()) {
    ParallelFor(painters.size(), [&](std::size_t i) {
      for (const GroundImage& image : images)
        if (painters[i].IsInReach(image)) painters[i].Paint(image);
    });
    FinishReady(painters, cells);
    ReleaseMemory(cells.surface().cells);
  }
}

/// Squares that are painted at once: neighbors where not all are.
std::vector<std::span<SquarePainter>> CutIntoParts(std::vector<SquarePainter>& painters,
                                                   double max_texels) {
  constexpr int kBlock = 4;  // squares
  double sum = 0;
  for (const SquarePainter& painter : painters) sum += painter.NumTexels();
  if (sum <= max_texels) return {painters};
  const auto block = [](int index) { return (index - (index < 0 ? kBlock - 1 : 0)) / kBlock; };
  std::stable_sort(painters.begin(), painters.end(),
                   [&](const SquarePainter& a, const SquarePainter& b) {
                     return std::pair(block(a.row()), block(a.column())) <
                            std::pair(block(b.row()), block(b.column()));
                   });
  std::vector<std::span<SquarePainter>> parts;
  for (std::size_t begin = 0, end; begin < painters.size(); begin = end) {
    sum = painters[begin].NumTexels();
    for (end = begin + 1; end < painters.size() && sum + painters[end].NumTexels() <= max_texels;
         ++end)
      sum += painters[end].NumTexels();
    parts.push_back(std::span(painters).subspan(begin, end - begin));
  }
  return parts;
}

/// A view whose image was chosen.
struct ChosenImage {
  int drive = 0, camera = 0;
  Timestamp time;
  GroundImage image;
};

/// Looks at all images once to bring them to one light.
void CalibrateImages(std::vector<ChosenImage>& chosen, std::span<const TextureSource> sources,
                     const CellFinder& cells, std::vector<Eigen::Vector3d> places,
                     double max_range) {
  LightMeter meter(std::move(places), chosen.size(), max_range);
  std::map<int, ImageChoice> choices;  // per drive
  std::vector<GroundImage*> images;
  for (ChosenImage& one : chosen) {
    one.image.index = static_cast<std::uint32_t>(images.size());
    images.push_back(&one.image);
    choices[one.drive].emplace(std::pair(one.camera, one.time), one.image);
  }
  for (const auto& [drive, choice] : choices) {
    ImageReader reader(*FindSource(sources, drive)->log, choice);
    for (auto batch = reader.Next(); !batch.empty(); batch = reader.Next()) {
      meter.Measure(batch, cells);
      ReleaseMemory(cells.surface().cells);
    }
  }
  meter.Balance(images);
}

/// The charts of some squares.
std::vector<TextureChart> PaintPart(std::span<SquarePainter> painters,
                                    const std::vector<ChosenImage>& chosen,
                                    std::span<const TextureSource> sources,
                                    const CellFinder& cells) {
  std::map<int, ImageChoice> choices;  // per drive
  for (const ChosenImage& one : chosen)
    for (SquarePainter& painter : painters) {
      if (!painter.IsInReach(one.image)) continue;
      choices[one.drive].emplace(std::pair(one.camera, one.time), one.image);
      painter.ExpectImage(one.image);
    }
  for (const auto& [drive, choice] : choices)
    PaintDrive(*FindSource(sources, drive)->log, choice, cells, painters);
  ParallelFor(painters.size(), [&](std::size_t i) {
    if (painters[i].charts().empty()) painters[i].Finish(cells);
  });
  std::vector<TextureChart> charts;
  for (SquarePainter& painter : painters) {
    std::move(painter.charts().begin(), painter.charts().end(), std::back_inserter(charts));
    painter.charts().clear();
  }
  return charts;
}

/// Where there is more of them than fits at once, images wait on disk.
std::shared_ptr<const FileBackedVector<std::uint8_t>> MoveToScratch(
    std::vector<TextureChart>& charts) {
  std::size_t size = 0;
  const auto size_of = [](const cv::Mat& image) { return image.total() * image.elemSize(); };
  for (const TextureChart& chart : charts) size += size_of(chart.image) + size_of(chart.mask);
  const auto pixels = std::make_shared<FileBackedVector<std::uint8_t>>(size);
  std::uint8_t* next = pixels->data();
  for (TextureChart& chart : charts)
    for (cv::Mat* image : {&chart.image, &chart.mask}) {
      const cv::Mat moved(image->rows, image->cols, image->type(), next);
      next += size_of(*image);
      image->copyTo(moved);
      *image = moved;
    }
  ReleaseMemory(*pixels);
  return pixels;
}

}  // namespace

void TextureOptions::Validate() const {
  Require(texel_size >= 0.002 && texel_size <= 1, ErrorCode::kUsage,
          "texel_size must be in 0.002..1 m");
  Require(chart_size >= 10 * texel_size && chart_size <= 8000 * texel_size, ErrorCode::kUsage,
          "chart_size must be 10 to 8000 texels");
  Require(max_range > 0, ErrorCode::kUsage, "max_range must be > 0 m");
  Require(max_texels > 0, ErrorCode::kUsage, "max_texels must be > 0");
}

GroundTexture PaintTexture(const TriangleMesh& mesh, const SurfaceMap& surface,
                           const PatchSource& patches, std::span<const TextureSource> sources,
                           const TextureOptions& options) {
  options.Validate();
  GroundTexture texture{options.texel_size, options.chart_size, {}};
  if (!options.enabled || mesh.empty()) return texture;
  std::vector<GroundImage> images;
  images.reserve(patches.views().size());
  std::vector<std::size_t> used;  // the image's patch
  for (std::size_t i = 0; i < patches.views().size(); ++i) {
    const PatchView& view = patches.views()[i];
    if (const TextureSource* source = FindSource(sources, view.drive)) {
      images.push_back(ImageOf(view, *source));
      used.push_back(i);
    }
  }
  std::vector<ChartSquare> squares = CutIntoSquares(mesh, options.chart_size);
  const CellFinder cells(surface);
  const FreeClearance clearance(cells);
  const auto free_rays = [&](std::size_t i) {
    return FreeRays(images[i].site_from_camera, images[i].site_from_ground, options.max_range,
                    clearance);
  };
  const ObstacleChecks obstacles{
      .may_show = [&](std::size_t i,
                      const Eigen::Vector2d& place) { return free_rays(i).Reach(place); },
      .prepare =
          [&](std::size_t i) {
            images[i].open_ground = VisibilityHorizon(free_rays(i));
            images[i].open_ground.HideBehind(patches.Read(used[i]),
                                             images[i].site_from_camera.translation.head<2>());
          }};
  const std::vector<bool> is_chosen =
      ChooseImages(images, PlacesOn(squares, mesh, kPlaceDistance), options.max_range, obstacles);
  std::vector<ChosenImage> chosen;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (is_chosen[i]) {
      const PatchView& view = patches.views()[used[i]];
      chosen.push_back({view.drive, view.camera, view.time, images[i]});
    }
  CalibrateImages(chosen, sources, cells, PlacesOn(squares, mesh, kLightPlaceDistance),
                  options.max_range);
  std::vector<SquarePainter> painters;
  painters.reserve(squares.size());
  for (ChartSquare& square : squares) painters.emplace_back(std::move(square), mesh, options);
  const std::vector<std::span<SquarePainter>> parts = CutIntoParts(painters, options.max_texels);
  for (const std::span<SquarePainter> part : parts) {
    std::vector<TextureChart> charts = PaintPart(part, chosen, sources, cells);
    if (parts.size() > 1) texture.pixels.push_back(MoveToScratch(charts));
    std::move(charts.begin(), charts.end(), std::back_inserter(texture.charts));
    ReleaseMemory(surface.cells);
  }
  std::sort(texture.charts.begin(), texture.charts.end(),
            [](const TextureChart& a, const TextureChart& b) {
              return std::tie(a.row, a.column, a.layer) < std::tie(b.row, b.column, b.layer);
            });
  LogInfo("stage=paint_texture charts=" + std::to_string(texture.charts.size()) +
          " images=" + std::to_string(chosen.size()) + " of " + std::to_string(images.size()));
  return texture;
}

}  // namespace parkade
