#include "mapping/baselines/fuse_voxels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/error.h"

namespace parkade {
namespace {

constexpr double kVoxelSize = 0.1;   // [m]; a multiple of the surface's cells
constexpr double kTruncation = 0.2;  // [m] along a ray, before and behind where it meets the plane
constexpr double kFreeLogOdds = 1;   // of one observation, for or against
constexpr float kMaxWeight = 10000;  // of a voxel: as in the paper's fusion, next to no forgetting

struct Voxel {
  float distance = 0;  ///< [m] signed: positive above the ground
  float weight = 0;
  float log_odds = 0;
  std::array<float, 3> color{};  ///< weighted mean, red green blue
};

class VoxelGrid {
 public:
  explicit VoxelGrid(double size) : size_(size) {}

  Voxel& At(const Eigen::Vector3i& index) {
    return columns_[KeyOf(index.x(), index.y())][index.z()];
  }
  Eigen::Vector3i IndexOf(const Eigen::Vector3d& point) const {
    return (point / size_).array().floor().matrix().cast<int>();
  }
  Eigen::Vector3d CenterOf(const Eigen::Vector3i& index) const {
    return size_ * (index.cast<double>() + Eigen::Vector3d::Constant(0.5));
  }

  template <typename Visitor>
  void VisitColumns(const Visitor& visit) const {
    for (const auto& [key, column] : columns_)
      visit(static_cast<int>(static_cast<std::uint32_t>(key >> 32)),
            static_cast<int>(static_cast<std::uint32_t>(key)), column);
  }

 private:
  static std::uint64_t KeyOf(int x, int y) {
    return (std::uint64_t{static_cast<std::uint32_t>(x)} << 32) | static_cast<std::uint32_t>(y);
  }
  double size_;
  std::unordered_map<std::uint64_t, std::map<int, Voxel>> columns_;
};

void Integrate(const GroundSample& sample, float distance, float log_odds, Voxel& voxel) {
  const float weight = voxel.weight + 1;
  voxel.distance += (distance - voxel.distance) / weight;
  const std::array<float, 3> color{static_cast<float>(sample.red), static_cast<float>(sample.green),
                                   static_cast<float>(sample.blue)};
  for (size_t c = 0; c < 3; ++c) voxel.color[c] += (color[c] - voxel.color[c]) / weight;
  voxel.weight = std::min(weight, kMaxWeight);
  voxel.log_odds += log_odds;
}

/// Every voxel that the ray passes within the truncation gets the distance to the sample along the
/// ray.
void CastRay(const Eigen::Vector3d& eye, const Eigen::Vector3d& point, const GroundSample& sample,
             VoxelGrid& grid) {
  const Eigen::Vector3d ray = (point - eye).normalized();
  const auto log_odds =
      static_cast<float>((sample.is_free ? 1 : -1) * kFreeLogOdds) * sample.confidence;
  Eigen::Vector3i last = Eigen::Vector3i::Constant(INT_MAX);
  for (double along = -kTruncation; along <= kTruncation; along += 0.5 * kVoxelSize) {
    const Eigen::Vector3i index = grid.IndexOf(point + along * ray);
    if (index == last) continue;
    last = index;
    const double distance = (point - grid.CenterOf(index)).dot(ray);
    Integrate(sample, static_cast<float>(std::clamp(distance, -kTruncation, kTruncation)), log_odds,
              grid.At(index));
  }
}

/// Cells of the surface where a column of voxels passes from below the ground to above it.
void AddCells(int x, int y, const std::map<int, Voxel>& column, int cells_per_voxel,
              double voxel_size, SurfaceMap& surface) {
  for (auto below = column.begin(); below != column.end(); ++below) {
    const auto above = std::next(below);
    if (above == column.end() || above->first != below->first + 1) continue;
    if (below->second.distance >= 0 || above->second.distance < 0) continue;
    const float fraction =
        below->second.distance / (below->second.distance - above->second.distance);
    const Voxel& nearer = fraction < 0.5F ? below->second : above->second;
    SurfaceCell cell;
    cell.height =
        static_cast<float>(voxel_size * (below->first + 0.5 + static_cast<double>(fraction)));
    cell.height_sigma = static_cast<float>(voxel_size);
    cell.free_belief = 1 / (1 + std::exp(-(below->second.log_odds + above->second.log_odds)));
    for (size_t c = 0; c < 3; ++c)
      cell.color[c] = static_cast<std::uint8_t>(std::lround(nearer.color[c]));
    for (int i = 0; i < cells_per_voxel * cells_per_voxel; ++i) {
      cell.x = x * cells_per_voxel + i % cells_per_voxel;
      cell.y = y * cells_per_voxel + i / cells_per_voxel;
      surface.cells.push_back(cell);
    }
  }
}

}  // namespace

SurfaceMap FuseVoxels(const PatchSource& patches, std::span<const DrivenPath> paths,
                      double cell_size) {
  const int cells_per_voxel = static_cast<int>(std::lround(kVoxelSize / cell_size));
  Require(cells_per_voxel >= 1 && std::abs(cells_per_voxel * cell_size - kVoxelSize) < 1e-9,
          ErrorCode::kUsage, "voxel_size must be a multiple of cell_size");
  VoxelGrid grid(kVoxelSize);
  for (size_t i = 0; i < patches.views().size(); ++i) {
    const PosedGroundPatch posed = patches.Read(i);
    const DrivenPath* path = FindPath(paths, posed.patch.drive);
    const auto camera = static_cast<size_t>(posed.patch.camera);
    if (path == nullptr || camera >= path->cameras_in_body.size()) continue;
    const Eigen::Vector3d eye = posed.site_from_body * path->cameras_in_body[camera];
    for (const GroundSample& sample : posed.patch.samples) {
      if (sample.confidence <= 0) continue;
      CastRay(eye, posed.site_from_body * sample.point_in_body.cast<double>(), sample, grid);
    }
  }
  SurfaceMap surface{cell_size, {}};
  grid.VisitColumns([&](int x, int y, const std::map<int, Voxel>& column) {
    AddCells(x, y, column, cells_per_voxel, kVoxelSize, surface);
  });
  std::sort(surface.cells.begin(), surface.cells.end(),
            [](const SurfaceCell& a, const SurfaceCell& b) {
              return std::tie(a.y, a.x, a.height) < std::tie(b.y, b.x, b.height);
            });
  return surface;
}

}  // namespace parkade
