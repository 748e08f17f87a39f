#include "mapping/kerbs/kerb_gaps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/kerbs/kerb_ends.h"
#include "mapping/kerbs/kerb_steps.h"

namespace parkade {
namespace {

using Eigen::Vector3d;

constexpr double kMinGain = 2;    // [m] by which a kerb grows that meets no other
constexpr double kClosed = 0.75;  // [m] between the ends of a kerb that is a ring

/// A kerb, its two ends and what was found beyond them.
struct OpenKerb {
  Kerb kerb;
  KerbEnd head = {}, tail = {};
  std::optional<KerbWalk> before = {}, after = {};  ///< that led somewhere
  std::optional<std::size_t> next = {}, previous = {};
};

bool AreAlike(const Kerb& a, const Kerb& b) {
  return Agree(KerbStep{a.height, a.height_sigma}, KerbStep{b.height, b.height_sigma});
}

/// The points of a kerb but for so much at its ends.
std::vector<Vector3d> Cut(const std::vector<Vector3d>& points, double head, double tail) {
  if (head == 0 && tail == 0) return points;
  const std::vector<Vector3d> spaced = Spaced(points);
  const auto steps = [](double length) {
    return static_cast<std::ptrdiff_t>(std::lround(length / KerbPlace::kSpacing));
  };
  if (steps(head) + steps(tail) + 2 > static_cast<std::ptrdiff_t>(spaced.size())) return points;
  return {spaced.begin() + steps(head), spaced.end() - steps(tail)};
}

void Append(const KerbWalk& walk, bool is_backward, Kerb& kerb) {
  std::vector<Vector3d> points = walk.points;
  if (is_backward) std::reverse(points.begin(), points.end());
  kerb.points.insert(kerb.points.end(), points.begin(), points.end());
  kerb.hidden_length += walk.hidden_length + walk.hidden_before_met;
}

/// Several kerbs in a row as one, with what was found before and behind them.
Kerb Join(std::span<const std::size_t> chain, std::span<const OpenKerb> kerbs) {
  Kerb joined;
  joined.height_sigma = kerbs[chain.front()].kerb.height_sigma;
  double weights = 0, squares = 0;
  for (const std::size_t i : chain) {
    const OpenKerb& one = kerbs[i];
    if (one.before) Append(*one.before, true, joined);
    const std::vector<Vector3d> own =
        Cut(one.kerb.points, one.before || one.previous ? one.head.hook : 0,
            one.after || one.next ? one.tail.hook : 0);
    joined.points.insert(joined.points.end(), own.begin(), own.end());
    joined.hidden_length += one.kerb.hidden_length;
    if (one.after) Append(*one.after, false, joined);
    const double weight = 1 / (one.kerb.height_sigma * one.kerb.height_sigma);
    joined.height += weight * one.kerb.height;
    squares += weight * one.kerb.height * one.kerb.height;
    weights += weight;
    joined.height_sigma = std::min(joined.height_sigma, one.kerb.height_sigma);
  }
  if (kerbs[chain.back()].next == chain.front()) joined.points.push_back(joined.points.front());
  joined.height /= weights;
  const double variance = squares / weights - joined.height * joined.height;
  joined.height_sigma = std::max(joined.height_sigma, std::sqrt(std::max(0.0, variance)));
  return joined;
}

/// Kerbs that lead to each other, in order.
std::vector<std::vector<std::size_t>> FindChains(std::span<const OpenKerb> kerbs) {
  std::vector<std::vector<std::size_t>> chains;
  std::vector<bool> is_done(kerbs.size());
  for (const bool may_be_ring : {false, true})
    for (std::size_t i = 0; i < kerbs.size(); ++i) {
      if (is_done[i] || (kerbs[i].previous && !may_be_ring)) continue;
      std::vector<std::size_t>& chain = chains.emplace_back();
      for (std::optional<std::size_t> at = i; at && !is_done[*at]; at = kerbs[*at].next)
        chain.push_back(*at), is_done[*at] = true;
    }
  return chains;
}

/// The ends that a kerb may lead to, by kerb: its own other one, too, around an island.
std::vector<const KerbEnd*> EndsToMeet(std::span<const OpenKerb> kerbs, std::size_t from,
                                       bool is_forward) {
  std::vector<const KerbEnd*> ends;
  ends.reserve(kerbs.size());
  for (std::size_t i = 0; i < kerbs.size(); ++i) {
    const OpenKerb& other = kerbs[i];
    const bool is_open =
        is_forward ? !other.previous && !other.before : !other.next && !other.after;
    const bool may_meet = is_open && AreAlike(other.kerb, kerbs[from].kerb);
    ends.push_back(!may_meet ? nullptr : is_forward ? &other.head : &other.tail);
  }
  return ends;
}

bool IsLong(const KerbWalk& walk, const KerbEnd& end) {
  return !walk.points.empty() && (walk.points.back() - end.foot).norm() >= kMinGain;
}

/// What following one end of a kerb leads to, if that is something.
std::optional<KerbWalk> FollowEnd(std::span<const OpenKerb> kerbs, std::size_t i, bool is_forward,
                                  const KerbWalker& walker) {
  const OpenKerb& from = kerbs[i];
  const KerbEnd& end = is_forward ? from.tail : from.head;
  const double left = is_forward ? 1 : -1;
  const std::vector<const KerbEnd*> others = EndsToMeet(kerbs, i, is_forward);
  std::vector<KerbEnd> ways{end};
  if (!end.line) ways = AroundCorners(end, PlacesAlong(from.kerb, i), left);
  for (const KerbEnd& way : ways) {
    KerbWalk walk = walker.Follow(way, i, left, others);
    if (walk.met || IsLong(walk, way)) return walk;
  }
  return {};
}

/// Whether a kerb goes all around something.
bool IsClosed(const Kerb& kerb) {
  return kerb.Length() > 4 * kClosed &&
         (kerb.points.front() - kerb.points.back()).norm() <= kClosed;
}

/// Follows one end of a kerb, and keeps what that led to.
void Extend(std::span<OpenKerb> kerbs, std::size_t i, bool is_forward, const KerbWalker& walker,
            TakenPlaces& taken) {
  OpenKerb& from = kerbs[i];
  if ((is_forward ? from.next : from.previous) || IsClosed(from.kerb)) return;
  std::optional<KerbWalk> walk = FollowEnd(kerbs, i, is_forward, walker);
  if (!walk) return;
  if (walk->met) {
    (is_forward ? from.next : from.previous) = walk->met;
    (is_forward ? kerbs[*walk->met].previous : kerbs[*walk->met].next) = i;
  }
  std::vector<Vector3d> way = {(is_forward ? from.tail : from.head).start};
  std::ranges::copy(walk->points, std::back_inserter(way));
  if (walk->met)
    way.push_back((is_forward ? kerbs[*walk->met].head : kerbs[*walk->met].tail).start);
  taken.Add(way, kerbs.size() + i);  // its other end must not go there again
  (is_forward ? from.after : from.before) = std::move(walk);
}

}  // namespace

void CloseGaps(const SurfaceMap& surface, std::span<const NoKerb> no_kerbs,
               std::vector<Kerb>& kerbs) {
  // Those that know best where they lead to come first, and are not doubled by others.
  std::ranges::stable_sort(kerbs, std::greater(), &Kerb::Length);
  TakenPlaces taken;
  std::vector<KerbPlace> all;
  for (std::size_t i = 0; i < kerbs.size(); ++i) {
    taken.Add(kerbs[i].points, i);
    std::ranges::copy(PlacesAlong(kerbs[i], i), std::back_inserter(all));
  }
  std::vector<OpenKerb> open;
  open.reserve(kerbs.size());
  for (const Kerb& kerb : kerbs) open.push_back({kerb});
  ParallelFor(open.size(), [&](std::size_t i) {
    std::vector<KerbPlace> places = PlacesAlong(open[i].kerb, i);
    open[i].head = FindEnd(places, -1, all);
    std::ranges::reverse(places);
    open[i].tail = FindEnd(places, 1, all);
  });
  const CellFinder cells(surface);
  const KerbWalker walker(cells, no_kerbs, taken);
  for (std::size_t i = 0; i < open.size(); ++i)
    for (const bool is_forward : {true, false}) Extend(open, i, is_forward, walker, taken);
  kerbs.clear();
  for (const std::vector<std::size_t>& chain : FindChains(open)) kerbs.push_back(Join(chain, open));
}

}  // namespace parkade
