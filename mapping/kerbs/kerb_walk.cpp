#include "mapping/kerbs/kerb_walk.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kStep = KerbPlace::kSpacing;
constexpr double kMaxUnseen = 2;                    // [m] of it that no vehicle hides
constexpr double kShortGap = 0.5;                   // [m] that counts as seen
constexpr double kMaxOff = 0.25, kMaxTurn = 0.015;  // [m] off the line, more by so much a meter
constexpr double kApart = 0.5;                      // [m] between kerbs that are two
constexpr int kMaxTaken = 6;                        // steps beside a kerb that is not met
constexpr std::size_t kMinDenials = 3;              // strips of an outline
constexpr double kBeside = 0.35;                    // [m] from the line to one of them
constexpr double kWeightOfEdge = 0.25;              // of what looks like a kerb beside a strip's
constexpr double kRow = 0.1;                        // [m] between places across the line
constexpr double kClear = 0.5;                      // belief
// Rows outward from the line among which are: what hides it, the ground before it, the kerb's edge,
// and what lies beyond.
constexpr int kFirstHiding = -25, kFirstGround = -10, kFirstEdge = -5, kLastGround = 2,
              kFirstBeyond = 3, kLastEdge = 5, kLastRow = 8;
constexpr int kMinOpen = 3, kMinStone = 2, kMinRaised = 3;  // rows

/// What lies across the line of a kerb at one place.
struct CrossSection {
  bool is_open = false;               ///< ground that can be driven on lies beyond
  bool is_hidden = false;             ///< by a vehicle
  bool shows_stone = false;           ///< not only what lies behind it
  std::optional<double> edge = {};    ///< [m] outward, where what looks like a kerb begins
  std::optional<double> ground = {};  ///< [m] height of the ground before it
};

/// Rows across the line that show one kind of thing.
struct RowsOf {
  std::optional<double> edge = {};  ///< [m] outward, where the first begins
  int count = 0;

  void Add(int row) {
    if (!edge && row <= kLastEdge) edge = row * kRow;
    ++count;
  }
};

CrossSection LookAcross(const Vector3d& foot, const Vector2d& outward, const CellFinder& cells) {
  CrossSection section;
  RowsOf stone, raised;
  int num_open = 0;
  for (int row = kFirstHiding; row <= kLastRow; ++row) {
    const Vector2d place = foot.head<2>() + row * kRow * outward;
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), foot.z()});
    if (cell == nullptr ||
        std::abs(static_cast<double>(cell->height) - foot.z()) > KerbPlace::kSameDeck)
      continue;
    const auto belief = [&](SurfaceClass surface) {
      return cell->class_beliefs[static_cast<std::size_t>(surface)] / 255.0;
    };
    const bool is_free = cell->free_belief > 0.5F;
    if (is_free && row >= kFirstBeyond) ++num_open;
    if (is_free && row >= kFirstGround && row <= kLastGround)
      section.ground = static_cast<double>(cell->height);
    if (row <= kFirstBeyond && cell->Surface() == SurfaceClass::kVehicle) section.is_hidden = true;
    if (is_free || row < kFirstEdge) continue;
    const double kerb = belief(SurfaceClass::kKerb);
    if (kerb >= kClear) stone.Add(row);
    if (kerb + belief(SurfaceClass::kPavement) + belief(SurfaceClass::kVegetation) >= kClear)
      raised.Add(row);
  }
  section.is_open = num_open >= kMinOpen;
  section.shows_stone = stone.count >= kMinStone && stone.edge;
  if (section.shows_stone)
    section.edge = stone.edge;
  else if (section.is_hidden && raised.count >= kMinRaised)
    section.edge = raised.edge;  // the stone itself is hidden
  return section;
}

double MaxOff(double hidden) { return kMaxOff + kMaxTurn * hidden; }

/// The nearest end that is met.
std::optional<std::size_t> FindMet(const Vector3d& foot, const Vector2d& direction, double hidden,
                                   std::span<const KerbEnd* const> others) {
  std::optional<std::size_t> met;
  double least = kStep;  // [m] along the way
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (others[i] == nullptr) continue;
    const Vector3d off = others[i]->start - foot;
    const double along = std::abs(off.head<2>().dot(direction));
    const Vector2d& outward = others[i]->line ? others[i]->line->direction : others[i]->outward;
    if (along > least || std::abs(Beside(off.head<2>(), direction)) > MaxOff(hidden) ||
        std::abs(off.z()) > KerbPlace::kSameDeck || outward.dot(direction) > -KerbPlace::kParallel)
      continue;
    met = i, least = along;
  }
  return met;
}

std::pair<int, int> SquareOf(const Vector3d& place) {
  return {static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y()))};
}

}  // namespace

void TakenPlaces::Add(const std::vector<Vector3d>& line, std::size_t kerb) {
  if (line.empty()) return;
  for (const Vector3d& place : Spaced(line)) squares_[SquareOf(place)].emplace_back(place, kerb);
}

bool TakenPlaces::IsTaken(const Vector3d& place, std::size_t kerb) const {
  static_assert(kApart <= 1);
  const auto [column, row] = SquareOf(place);
  const auto is_taken = [&](const std::pair<Vector3d, std::size_t>& other) {
    const Vector3d off = other.first - place;
    return other.second != kerb && off.head<2>().norm() <= kApart &&
           std::abs(off.z()) <= KerbPlace::kSameDeck;
  };
  for (int x = column - 1; x <= column + 1; ++x)
    for (int y = row - 1; y <= row + 1; ++y) {
      const auto square = squares_.find({x, y});
      if (square != squares_.end() && std::ranges::any_of(square->second, is_taken)) return true;
    }
  return false;
}

KerbWalker::KerbWalker(const CellFinder& cells, std::span<const NoKerb> no_kerbs,
                       const TakenPlaces& taken)
    : cells_(&cells), taken_(&taken) {
  for (const NoKerb& place : no_kerbs) no_kerbs_[SquareOf(place.foot)].push_back(place);
}

std::size_t KerbWalker::CountDenials(const Vector3d& foot, const Vector2d& direction) const {
  static_assert(kBeside <= 1 && kStep <= 1);
  const auto denies = [&](const NoKerb& place) {
    const Vector3d off = place.foot - foot;
    return std::abs(off.head<2>().dot(direction)) <= 0.5 * kStep &&
           std::abs(Beside(off.head<2>(), direction)) <= kBeside &&
           std::abs(off.z()) <= KerbPlace::kSameDeck &&
           std::abs(place.along.dot(direction)) >= KerbPlace::kParallel;
  };
  std::size_t count = 0;
  const auto [column, row] = SquareOf(foot);
  for (int x = column - 1; x <= column + 1; ++x)
    for (int y = row - 1; y <= row + 1; ++y)
      if (const auto square = no_kerbs_.find({x, y}); square != no_kerbs_.end())
        count += static_cast<std::size_t>(std::ranges::count_if(square->second, denies));
  return count;
}

KerbWalk KerbWalker::Follow(const KerbEnd& end, std::size_t kerb, double left,
                            std::span<const KerbEnd* const> others) const {
  KerbWalk walk;
  KerbAxis line = *end.line;
  std::vector<KerbPlace> known = end.on_line;
  double at = line.Along(end.start);
  double hidden = 0, unseen = 0;
  std::size_t num_denials = 0;
  int num_taken = 0;
  while (unseen <= kMaxUnseen && hidden <= end.max_hidden) {
    hidden += kStep, at += kStep;
    const Vector2d outward = left * Vector2d(line.direction.y(), -line.direction.x());
    const Vector3d foot = line.At(at);
    const CrossSection section = LookAcross(foot, outward, *cells_);
    num_denials += CountDenials(foot, line.direction);
    if (section.is_open || num_denials >= kMinDenials) break;
    walk.met = FindMet(foot, line.direction, hidden, others);
    if (walk.met) {
      walk.hidden_before_met = hidden > kShortGap ? hidden : 0;
      break;
    }
    if (taken_->IsTaken(foot, kerb)) {
      if (++num_taken > kMaxTaken) break;
      continue;
    }
    num_taken = 0;
    if (!section.edge || std::abs(*section.edge) > MaxOff(hidden)) {
      if (!section.is_hidden) unseen += kStep;
      continue;
    }
    Vector3d seen = foot;
    seen.head<2>() += *section.edge * outward;
    if (section.ground) seen.z() = *section.ground;
    known.push_back({seen, line.direction, kerb, kWeightOfEdge});
    line = FitAxis(known, line.direction);
    at = line.Along(seen);
    walk.points.push_back(line.At(at));
    walk.hidden_length += hidden > kShortGap || !section.shows_stone ? hidden : 0;
    hidden = unseen = 0;
    num_denials = 0;
  }
  return walk;
}

}  // namespace parkade
