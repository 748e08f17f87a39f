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
#include "mapping/texture/choose_photos.h"
#include "mapping/texture/light_meter.h"
#include "mapping/texture/photo_reader.h"

namespace parkade {
namespace {

constexpr double kPlaceDistance = 0.5;       // [m] between places that photos are chosen for ...
constexpr double kLightPlaceDistance = 1.0;  // ... and at which their light is compared

const TextureSource* FindSource(std::span<const TextureSource> sources, int drive) {
  const auto found = std::find_if(sources.begin(), sources.end(),
                                  [&](const TextureSource& source) { return source.path->drive == drive; });
  return found == sources.end() ? nullptr : &*found;
}

/// A photo that is yet to be read.
GroundPhoto PhotoOf(const PatchView& view, const TextureSource& source) {
  const RigCamera& camera = source.log->rig().cameras[static_cast<std::size_t>(view.camera)];
  return {.image = {},
          .camera = &camera,
          .site_from_camera = view.site_from_body * camera.body_from_camera,
          .site_from_ground = view.site_from_body * source.path->body_from_ground,
          .contact = source.path->contact,
          .drive = view.drive};
}

/// Places on the mesh, evenly spread.
std::vector<Eigen::Vector3d> PlacesOn(const std::vector<ChartSquare>& squares, const TriangleMesh& mesh,
                                      double distance) {
  const auto of_squares = ParallelMap(squares.size(), [&](std::size_t i) {
    std::vector<Eigen::Vector3d> places;
    for (const BlankChart& blank : ChartsOf(squares[i], mesh, distance))
      for (int row = 0; row < blank.height.rows; ++row)
        for (int column = 0; column < blank.height.cols; ++column)
          if (const float height = blank.height.at<float>(row, column); !std::isnan(height))
            places.emplace_back(blank.chart.left + (column + 0.5) * distance, blank.chart.top - (row + 0.5) * distance,
                                height);
    return places;
  });
  std::vector<Eigen::Vector3d> all;
  for (const auto& places : of_squares) all.insert(all.end(), places.begin(), places.end());
  return all;
}

/// The charts of one square: nothing but triangles until the first photo comes, pictures after the last.
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

  bool IsInReach(const GroundPhoto& photo) const {
    return box_.exteriorDistance(photo.site_from_camera.translation.head<2>().eval()) <= options_->max_range;
  }

  void ExpectPhoto() { ++num_to_come_; }

  void Paint(const GroundPhoto& photo) {
    Begin();
    for (ChartPainter& painter : painters_) painter.Paint(photo, options_->max_range);
    --num_to_come_;
  }

  /// Nothing more is to come and the pictures are not made yet.
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
  Eigen::AlignedBox2d box_;  // [m] in site
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

void PaintDrive(const DriveLog& log, const PhotoChoice& choice, const CellFinder& cells,
                std::span<SquarePainter> painters) {
  PhotoReader reader(log, choice);
  for (std::vector<GroundPhoto> photos = reader.Next(); !photos.empty(); photos = reader.Next()) {
    ParallelFor(painters.size(), [&](std::size_t i) {
      for (const GroundPhoto& photo : photos)
        if (painters[i].IsInReach(photo)) painters[i].Paint(photo);
    });
    FinishReady(painters, cells);
    ReleaseMemory(cells.surface().cells);
  }
}

/// Squares that are painted at once: neighbours where not all are.
std::vector<std::span<SquarePainter>> CutIntoParts(std::vector<SquarePainter>& painters, double max_texels) {
  constexpr int kBlock = 4;  // squares
  double sum = 0;
  for (const SquarePainter& painter : painters) sum += painter.NumTexels();
  if (sum <= max_texels) return {painters};
  const auto block = [](int index) { return (index - (index < 0 ? kBlock - 1 : 0)) / kBlock; };
  std::stable_sort(painters.begin(), painters.end(), [&](const SquarePainter& a, const SquarePainter& b) {
    return std::pair(block(a.row()), block(a.column())) < std::pair(block(b.row()), block(b.column()));
  });
  std::vector<std::span<SquarePainter>> parts;
  for (std::size_t begin = 0, end; begin < painters.size(); begin = end) {
    sum = painters[begin].NumTexels();
    for (end = begin + 1; end < painters.size() && sum + painters[end].NumTexels() <= max_texels; ++end)
      sum += painters[end].NumTexels();
    parts.push_back(std::span(painters).subspan(begin, end - begin));
  }
  return parts;
}

/// A view whose image was chosen.
struct ChosenPhoto {
  int drive = 0, camera = 0;
  Timestamp time;
  GroundPhoto photo;
};

/// Looks at all photos once to bring them to one light.
void BalancePhotos(std::vector<ChosenPhoto>& chosen, std::span<const TextureSource> sources, const CellFinder& cells,
                   std::vector<Eigen::Vector3d> places, double max_range) {
  LightMeter meter(std::move(places), chosen.size(), max_range);
  std::map<int, PhotoChoice> choices;  // per drive
  std::vector<GroundPhoto*> photos;
  for (ChosenPhoto& one : chosen) {
    one.photo.index = static_cast<std::uint32_t>(photos.size());
    photos.push_back(&one.photo);
    choices[one.drive].emplace(std::pair(one.camera, one.time), one.photo);
  }
  for (const auto& [drive, choice] : choices) {
    PhotoReader reader(*FindSource(sources, drive)->log, choice);
    for (auto batch = reader.Next(); !batch.empty(); batch = reader.Next()) {
      meter.Measure(batch, cells);
      ReleaseMemory(cells.surface().cells);
    }
  }
  meter.Balance(photos);
}

/// The charts of some squares.
std::vector<TextureChart> PaintPart(std::span<SquarePainter> painters, const std::vector<ChosenPhoto>& chosen,
                                    std::span<const TextureSource> sources, const CellFinder& cells) {
  std::map<int, PhotoChoice> choices;  // per drive
  for (const ChosenPhoto& one : chosen)
    for (SquarePainter& painter : painters) {
      if (!painter.IsInReach(one.photo)) continue;
      choices[one.drive].emplace(std::pair(one.camera, one.time), one.photo);
      painter.ExpectPhoto();
    }
  for (const auto& [drive, choice] : choices) PaintDrive(*FindSource(sources, drive)->log, choice, cells, painters);
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

/// Where there is more of them than fits at once, pictures wait on disk.
std::shared_ptr<const ScratchVector<std::uint8_t>> MoveToScratch(std::vector<TextureChart>& charts) {
  std::size_t size = 0;
  const auto size_of = [](const cv::Mat& picture) { return picture.total() * picture.elemSize(); };
  for (const TextureChart& chart : charts) size += size_of(chart.image) + size_of(chart.mask);
  const auto pixels = std::make_shared<ScratchVector<std::uint8_t>>(size);
  std::uint8_t* next = pixels->data();
  for (TextureChart& chart : charts)
    for (cv::Mat* picture : {&chart.image, &chart.mask}) {
      const cv::Mat moved(picture->rows, picture->cols, picture->type(), next);
      next += size_of(*picture);
      picture->copyTo(moved);
      *picture = moved;
    }
  ReleaseMemory(*pixels);
  return pixels;
}

}  // namespace

void TextureOptions::Validate() const {
  Require(texel_size >= 0.002 && texel_size <= 1, ErrorCode::kUsage, "texel_size must be in 0.002..1 m");
  Require(chart_size >= 10 * texel_size && chart_size <= 8000 * texel_size, ErrorCode::kUsage,
          "chart_size must be 10 to 8000 texels");
  Require(max_range > 0, ErrorCode::kUsage, "max_range must be > 0 m");
  Require(max_texels > 0, ErrorCode::kUsage, "max_texels must be > 0");
}

GroundTexture PaintTexture(const TriangleMesh& mesh, const SurfaceMap& surface, std::span<const PatchView> views,
                           std::span<const TextureSource> sources, const TextureOptions& options) {
  options.Validate();
  GroundTexture texture{options.texel_size, options.chart_size, {}};
  if (!options.enabled || mesh.empty()) return texture;
  std::vector<GroundPhoto> photos;
  std::vector<PatchView> used;
  for (const PatchView& view : views)
    if (const TextureSource* source = FindSource(sources, view.drive)) {
      photos.push_back(PhotoOf(view, *source));
      used.push_back(view);
    }
  std::vector<ChartSquare> squares = CutIntoSquares(mesh, options.chart_size);
  const CellFinder cells(surface);
  const std::vector<bool> is_chosen =
      ChoosePhotos(photos, PlacesOn(squares, mesh, kPlaceDistance), options.max_range, [&](GroundPhoto& photo) {
        photo.open_ground = OpenGround(photo.site_from_camera, photo.site_from_ground, options.max_range, cells);
      });
  std::vector<ChosenPhoto> chosen;
  for (std::size_t i = 0; i < photos.size(); ++i)
    if (is_chosen[i]) chosen.push_back({used[i].drive, used[i].camera, used[i].time, photos[i]});
  BalancePhotos(chosen, sources, cells, PlacesOn(squares, mesh, kLightPlaceDistance), options.max_range);
  std::vector<SquarePainter> painters;
  for (ChartSquare& square : squares) painters.emplace_back(std::move(square), mesh, options);
  const std::vector<std::span<SquarePainter>> parts = CutIntoParts(painters, options.max_texels);
  for (const std::span<SquarePainter> part : parts) {
    std::vector<TextureChart> charts = PaintPart(part, chosen, sources, cells);
    if (parts.size() > 1) texture.pixels.push_back(MoveToScratch(charts));
    std::move(charts.begin(), charts.end(), std::back_inserter(texture.charts));
    ReleaseMemory(surface.cells);
  }
  std::sort(texture.charts.begin(), texture.charts.end(), [](const TextureChart& a, const TextureChart& b) {
    return std::tie(a.row, a.column, a.sheet) < std::tie(b.row, b.column, b.sheet);
  });
  LogInfo("stage=paint_texture charts=" + std::to_string(texture.charts.size()) +
          " photos=" + std::to_string(chosen.size()) + " of " + std::to_string(photos.size()));
  return texture;
}

}  // namespace parkade
