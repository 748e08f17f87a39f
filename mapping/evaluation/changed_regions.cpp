#include "mapping/evaluation/changed_regions.h"

#include <algorithm>
#include <utility>

namespace parkade {
namespace {

constexpr double kMinObstacleShare = 0.1;  // of the cells of a region that was or is blocked
constexpr double kMaxCellStep = 0.3;       // [m] of height between neighboring cells of one region

}  // namespace

CellPatches::CellPatches(const std::vector<ChangedCell>& cells, double cell_size)
    : cells_(cells), cell_size_(cell_size), is_in_(cells.size(), true) {
  SurfaceMap surface{cell_size, {}};
  for (const ChangedCell& cell : cells) surface.cells.push_back(cell.cell);
  links_ = LinkCells(surface, kMaxCellStep);
}

template <typename Rule>
void CellPatches::Step(const Rule& rule) {
  std::vector<bool> next(is_in_.size());
  for (size_t i = 0; i < is_in_.size(); ++i) next[i] = rule(i, is_in_);
  is_in_ = std::move(next);
}

void CellPatches::Open(int rounds) {
  for (int round = 0; round < rounds; ++round)
    Step(
        [&](size_t i, const std::vector<bool>& was) { return was[i] && CountAround(i, was) == 8; });
  for (int round = 0; round < rounds; ++round)
    Step([&](size_t i, const std::vector<bool>& was) { return was[i] || CountAround(i, was) > 0; });
}

std::vector<std::vector<size_t>> CellPatches::FindParts() const {
  std::vector<std::vector<size_t>> parts;
  std::vector<bool> is_found(cells_.size());
  for (size_t first = 0; first < cells_.size(); ++first) {
    if (!is_in_[first] || is_found[first]) continue;
    std::vector<size_t> part = {first};
    is_found[first] = true;
    for (size_t k = 0; k < part.size(); ++k)
      for (const std::vector<int>* links :
           {&links_.left, &links_.right, &links_.down, &links_.up}) {
        const int next = (*links)[part[k]];
        if (next < 0 || !is_in_[static_cast<size_t>(next)] || is_found[static_cast<size_t>(next)])
          continue;
        is_found[static_cast<size_t>(next)] = true;
        part.push_back(static_cast<size_t>(next));
      }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

ChangedRegion CellPatches::RegionOf(GroundChange change, const std::vector<size_t>& part) const {
  ChangedRegion region{.change = change,
                       .area = static_cast<double>(part.size()) * cell_size_ * cell_size_};
  size_t num_obstacles = 0;
  for (const size_t index : part) {
    const auto& [cell, height_change, is_obstacle] = cells_[index];
    num_obstacles += is_obstacle;
    region.cells.push_back(cell);
    region.center += Eigen::Vector3d((cell.x + 0.5) * cell_size_, (cell.y + 0.5) * cell_size_,
                                     static_cast<double>(cell.height));
    region.height_change += height_change;
  }
  // Only a car's foot is sure; where there is none, what lies behind others came into
  // view or went out of it.
  if (static_cast<double>(num_obstacles) < kMinObstacleShare * static_cast<double>(part.size())) {
    if (change == GroundChange::kFreed) region.change = GroundChange::kMapped;
    if (change == GroundChange::kBlocked) region.change = GroundChange::kUnmapped;
  }
  region.center /= static_cast<double>(part.size());
  region.height_change /= static_cast<double>(part.size());
  return region;
}

int CellPatches::CountAround(size_t cell, const std::vector<bool>& is_in) const {
  int count = 0;
  for (const int next : links_.Around(static_cast<int>(cell)))
    count += next >= 0 && is_in[static_cast<size_t>(next)];
  return count;
}

}  // namespace parkade
