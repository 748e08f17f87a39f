#include "mapping/ground/latest_drives.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "mapping/ground/nearest_views.h"

namespace parkade {
namespace {

constexpr double kSquare = 4.0;   // [m]
constexpr double kDeck = 3.0;     // [m]
constexpr double kNear = 10.0;    // [m] from the car to the middle of a square
constexpr int kEnoughViews = 24;  // of a square, at least
// Views of a square that are chosen of a drive: fewer of the latest lose corners that others hide.
constexpr int kViewsOfLatest = 64, kViewsOfEarlier = 12;

int Index(double coordinate, double step) {
  return static_cast<int>(std::floor(coordinate / step));
}

/// How often drives after that of a rank looked.
int NumViewsAfter(const std::map<int, int>& num_views, int rank) {
  int sum = 0;
  for (auto drive = num_views.upper_bound(rank); drive != num_views.end(); ++drive)
    sum += drive->second;
  return sum;
}

}  // namespace

LatestDrives::Square LatestDrives::SquareOf(double car_height,
                                            const Eigen::Vector2d& point_in_site) {
  return {Index(car_height + 0.5 * kDeck, kDeck), Index(point_in_site.y(), kSquare),
          Index(point_in_site.x(), kSquare)};
}

/// Calls `visit(square, middle)` for squares whose middle is looked at.
template <typename Visitor>
void LatestDrives::ForEachMiddle(const PatchView& view, const Visitor& visit) {
  if (view.extent.isEmpty()) return;
  for (int y = Index(view.extent.min().y() + 0.5 * kSquare, kSquare);
       (y + 0.5) * kSquare <= view.extent.max().y(); ++y)
    for (int x = Index(view.extent.min().x() + 0.5 * kSquare, kSquare);
         (x + 0.5) * kSquare <= view.extent.max().x(); ++x) {
      const Eigen::Vector2d middle((x + 0.5) * kSquare, (y + 0.5) * kSquare);
      visit(SquareOf(view, middle), middle);
    }
}

LatestDrives::LatestDrives(std::span<const PatchView> views, int max_drives) : views_(views) {
  NumViews num_views, num_near_views;
  for (const PatchView& view : views) {
    const int rank = ranks_.try_emplace(view.drive, static_cast<int>(ranks_.size())).first->second;
    const Eigen::Vector2d place = view.site_from_body.translation.head<2>();
    last_driven_[SquareOf(view, place)] = rank;
    ForEachMiddle(view, [&](const Square& square, const Eigen::Vector2d& middle) {
      ++num_views[square][rank];
      if ((middle - place).norm() < kNear) ++num_near_views[square][rank];
    });
  }
  oldest_ = FindOldest(num_views, max_drives);
  FindNear(num_near_views, max_drives);
  ChooseViews(num_views);
}

std::map<LatestDrives::Square, int> LatestDrives::FindOldest(const NumViews& num_views,
                                                             int max_drives) {
  std::map<Square, int> oldest;
  for (const auto& [square, of_drives] : num_views) {
    int count = 0, sum = 0;
    for (auto drive = of_drives.rbegin(); drive != of_drives.rend(); ++drive) {
      sum += drive->second;
      if (++count < max_drives || sum < kEnoughViews) continue;
      oldest[square] = drive->first;
      break;
    }
  }
  return oldest;
}

void LatestDrives::FindNear(const NumViews& num_near_views, int max_drives) {
  const std::map<Square, int> oldest_near = FindOldest(num_near_views, max_drives);
  for (const auto& [square, of_drives] : num_near_views) {
    const auto oldest = oldest_.find(square);
    const auto from = oldest_near.find(square);
    if (oldest == oldest_.end()) continue;  // all count
    for (const auto& [rank, count] : of_drives)
      if (rank < oldest->second && (from == oldest_near.end() || rank >= from->second))
        near_.emplace(square, rank);
  }
}

/// Those too small to look at any square's middle are all chosen: no square counts them.
void LatestDrives::ChooseViews(const NumViews& num_views) {
  std::map<SquareOfDrive, std::uint32_t> targets;  // squares as a drive sees them
  std::vector<int> wanted;
  std::vector<Eigen::Vector2i> squares;  // of targets
  std::vector<TargetView> target_views;
  std::vector<std::size_t> narrow;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const int rank = ranks_.at(views_[i].drive);
    const Eigen::Vector2d place = views_[i].site_from_body.translation.head<2>();
    bool is_narrow = true;
    ForEachMiddle(views_[i], [&](const Square& square, const Eigen::Vector2d& middle) {
      is_narrow = false;
      if (!HasSay(rank, square)) return;
      const auto [target, is_new] =
          targets.try_emplace({square, rank}, static_cast<std::uint32_t>(wanted.size()));
      if (is_new) {
        wanted.push_back(NumViewsAfter(num_views.at(square), rank) < kEnoughViews
                             ? kViewsOfLatest
                             : kViewsOfEarlier);
        squares.emplace_back(std::get<2>(square), std::get<1>(square));
      }
      target_views.push_back({static_cast<float>((place - middle).norm()),
                              static_cast<std::uint32_t>(i), target->second});
    });
    if (is_narrow) narrow.push_back(i);
  }
  std::vector<bool> is_chosen = ChooseNearest(target_views, views_.size(), wanted);
  for (const std::size_t i : narrow) is_chosen[i] = true;
  share_of_.assign(views_.size(), 0);
  shares_.resize(1);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (!is_chosen[i]) continue;
    share_of_[i] = static_cast<std::uint32_t>(shares_.size());
    shares_.push_back(FullShareOf(i));
  }
  std::vector<int> counting = wanted;
  for (int& number : counting)
    if (number == kViewsOfLatest) number = std::numeric_limits<int>::max();
  const std::vector<bool> counts = NearestOfChosen(target_views, is_chosen, std::move(counting));
  for (std::size_t i = 0; i < target_views.size(); ++i)
    if (is_chosen[target_views[i].view] && !counts[i])
      shares_[share_of_[target_views[i].view]].Leave(squares[target_views[i].target]);
}

bool LatestDrives::HasSay(int rank, const Square& square) const {
  const auto oldest = oldest_.find(square);
  return oldest == oldest_.end() || rank >= oldest->second || near_.contains({square, rank});
}

bool LatestDrives::CountsAsDriven(int drive, const Eigen::Vector3d& car_in_site) const {
  const Square square = SquareOf(car_in_site.z(), car_in_site.head<2>());
  const auto rank = ranks_.find(drive);
  if (rank == ranks_.end() || HasSay(rank->second, square)) return true;
  const auto last = last_driven_.find(square);
  return last == last_driven_.end() || !HasSay(last->second, square);
}

/// All in which its drive has a say.
LatestDrives::Share LatestDrives::FullShareOf(std::size_t index) const {
  Share share;
  const PatchView& view = views_[index];
  if (view.extent.isEmpty()) return share;
  share.x_ = Index(view.extent.min().x(), kSquare),
  share.y_ = Index(view.extent.min().y(), kSquare);
  share.width_ = Index(view.extent.max().x(), kSquare) - share.x_ + 1;
  share.height_ = Index(view.extent.max().y(), kSquare) - share.y_ + 1;
  const int rank = ranks_.at(view.drive);
  for (int y = share.y_; y < share.y_ + share.height_; ++y)
    for (int x = share.x_; x < share.x_ + share.width_; ++x) {
      share.counts_.push_back(
          HasSay(rank, SquareOf(view, {(x + 0.5) * kSquare, (y + 0.5) * kSquare})));
      share.num_counting_ += share.counts_.back();
    }
  return share;
}

void LatestDrives::Share::Leave(const Eigen::Vector2i& square) {
  std::vector<bool>::reference counts =
      counts_[static_cast<size_t>((square.y() - y_) * width_ + square.x() - x_)];
  num_counting_ -= counts;
  counts = false;
}

Eigen::AlignedBox2d LatestDrives::Share::Extent() const {
  Eigen::AlignedBox2d extent;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      if (counts_[static_cast<size_t>(y * width_ + x)])
        extent.extend(kSquare * Eigen::Vector2d(x_ + x, y_ + y))
            .extend(kSquare * Eigen::Vector2d(x_ + x + 1, y_ + y + 1));
  return extent;
}

bool LatestDrives::Share::Counts(const Eigen::Vector2d& point_in_site) const {
  if (is_none()) return false;
  if (num_counting_ == width_ * height_) return true;
  const int x = std::clamp(Index(point_in_site.x(), kSquare) - x_, 0, width_ - 1);
  const int y = std::clamp(Index(point_in_site.y(), kSquare) - y_, 0, height_ - 1);
  return counts_[static_cast<size_t>(y * width_ + x)];
}

}  // namespace parkade
