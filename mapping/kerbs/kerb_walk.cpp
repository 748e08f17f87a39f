#include "mapping/kerbs/kerb_walk.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kStep = KerbPlace::kSpacing;
constexpr double kMaxHidden = 14;  // [m] in one piece: two cars and what is between
constexpr double kMaxUnseen = 2;   // [m] of it that no vehicle hides
constexpr double kShortGap = 0.5;  // [m] that counts as seen
constexpr double kMaxOff = 0.25, kMaxTurn = 0.015;  // [m] off the line, more by so much a meter
constexpr double kParallel = 0.94;                  // cosine
constexpr double kApart = 0.5;                      // [m] between kerbs that are two
constexpr int kMaxTaken = 3;                        // steps beside a kerb that is not met
constexpr std::size_t kMinDenials = 3;              // strips of an outline
constexpr double kBeside = 0.35;                    // [m] from the line to one of them
constexpr double kWeightOfEdge = 0.25;              // of what looks like a kerb beside a strip's
constexpr double kRow = 0.1;                        // [m] between places across the line
constexpr double kSameDeck = 1.0;                   // [m]
constexpr double kClear = 0.5;                      // belief
// Rows outward from the line among which are: what hides it, the ground before it, the kerb's edge,
// and what lies beyond.
constexpr int kFirstHiding = -25, kFirstGround = -10, kFirstEdge = -5, kLastGround = 2,
              kFirstBeyond = 3, kLastEdge = 5, kLastRow = 8;
constexpr int kMinOpen = 3, kMinStone = 2;  // rows

/// What lies across the line of a kerb at one place.
struct CrossSection {
  bool is_open = false;               ///< ground that can be driven on lies beyond
  bool is_hidden = false;             ///< by a vehicle
  std::optional<double> edge = {};    ///< [m] outward, where what looks like a kerb begins
  std::optional<double> ground = {};  ///< [m] height of the ground before it
};

CrossSection LookAcross(const Vector3d& foot, const Vector2d& outward, const CellFinder& cells) {
  CrossSection section;
  int num_open = 0, num_stone = 0;
  for (int row = kFirstHiding; row <= kLastRow; ++row) {
    const Vector2d place = foot.head<2>() + row * kRow * outward;
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), foot.z()});
    if (cell == nullptr || std::abs(static_cast<double>(cell->height) - foot.z()) > kSameDeck)
      continue;
    const bool is_free = cell->free_belief > 0.5F;
    if (is_free && row >= kFirstBeyond) ++num_open;
    if (is_free && row >= kFirstGround && row <= kLastGround)
      section.ground = static_cast<double>(cell->height);
    if (row <= kFirstBeyond && cell->Surface() == SurfaceClass::kVehicle) section.is_hidden = true;
    const double stone = cell->class_beliefs[static_cast<std::size_t>(SurfaceClass::kKerb)] / 255.0;
    if (is_free || stone < kClear || row < kFirstEdge) continue;
    if (!section.edge && row <= kLastEdge) section.edge = row * kRow;
    ++num_stone;
  }
  section.is_open = num_open >= kMinOpen;
  if (num_stone < kMinStone) section.edge.reset();
  return section;
}

double MaxOff(double hidden) { return kMaxOff + kMaxTurn * hidden; }

std::optional<std::size_t> FindMet(const Vector3d& foot, const Vector2d& direction, double hidden,
                                   std::span<const KerbEnd* const> others) {
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (others[i] == nullptr) continue;
    const Vector3d off = others[i]->foot - foot;
    if (std::abs(off.head<2>().dot(direction)) <= kStep + others[i]->hook &&
        std::abs(Beside(off.head<2>(), direction)) <= MaxOff(hidden) &&
        std::abs(off.z()) <= kSameDeck && others[i]->outward.dot(direction) <= -kParallel)
      return i;
  }
  return {};
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
    return other.second != kerb && off.head<2>().norm() <= kApart && std::abs(off.z()) <= kSameDeck;
  };
  for (int x = column - 1; x <= column + 1; ++x)
    for (int y = row - 1; y <= row + 1; ++y) {
      const auto square = squares_.find({x, y});
      if (square != squares_.end() && std::ranges::any_of(square->second, is_taken)) return true;
    }
  return false;
}

std::size_t KerbWalker::CountDenials(const Vector3d& foot, const Vector2d& direction) const {
  return static_cast<std::size_t>(std::ranges::count_if(no_kerbs_, [&](const NoKerb& place) {
    const Vector2d off = place.foot - foot.head<2>();
    return std::abs(off.dot(direction)) <= 0.5 * kStep &&
           std::abs(Beside(off, direction)) <= kBeside &&
           std::abs(place.along.dot(direction)) >= kParallel;
  }));
}

KerbWalk KerbWalker::Follow(const KerbEnd& end, std::size_t kerb, double left,
                            std::span<const KerbEnd* const> others) const {
  KerbWalk walk;
  KerbAxis line = *end.line;
  std::vector<KerbPlace> known = end.on_line;
  double at = line.Along(end.foot) - end.hook;
  double hidden = 0, unseen = 0;
  std::size_t num_denials = 0;
  int num_taken = 0;
  while (unseen <= kMaxUnseen && hidden <= kMaxHidden) {
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
    walk.hidden_length += hidden > kShortGap ? hidden : 0;
    hidden = unseen = 0;
  }
  return walk;
}

}  // namespace parkade
