#include "mapping/ground/latest_drives.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr double kSquare = 4.0;   // [m]
constexpr double kDeck = 3.0;     // [m]
constexpr int kEnoughViews = 24;  // of a square, at least

int Index(double coordinate, double step) {
  return static_cast<int>(std::floor(coordinate / step));
}

}  // namespace

LatestDrives::Square LatestDrives::SquareOf(const PatchView& view,
                                            const Eigen::Vector2d& point_in_site) {
  return {Index(view.site_from_body.translation.z() + 0.5 * kDeck, kDeck),
          Index(point_in_site.y(), kSquare), Index(point_in_site.x(), kSquare)};
}

LatestDrives::LatestDrives(std::span<const PatchView> views, int max_drives) {
  std::map<Square, std::map<int, int>> num_views;  // by square and rank of the drive
  for (const PatchView& view : views) {
    const int rank = ranks_.try_emplace(view.drive, static_cast<int>(ranks_.size())).first->second;
    if (view.extent.isEmpty()) continue;
    // Squares whose middle is looked at.
    for (int y = Index(view.extent.min().y() + 0.5 * kSquare, kSquare);
         (y + 0.5) * kSquare <= view.extent.max().y(); ++y)
      for (int x = Index(view.extent.min().x() + 0.5 * kSquare, kSquare);
           (x + 0.5) * kSquare <= view.extent.max().x(); ++x)
        ++num_views[SquareOf(view, {(x + 0.5) * kSquare, (y + 0.5) * kSquare})][rank];
  }
  for (const auto& [square, of_drives] : num_views) {
    int count = 0, sum = 0;
    for (auto drive = of_drives.rbegin(); drive != of_drives.rend(); ++drive) {
      sum += drive->second;
      if (++count < max_drives || sum < kEnoughViews) continue;
      oldest_[square] = drive->first;
      break;
    }
  }
}

LatestDrives::Share LatestDrives::ShareOf(const PatchView& view) const {
  Share share;
  if (view.extent.isEmpty()) return share;
  share.x_ = Index(view.extent.min().x(), kSquare),
  share.y_ = Index(view.extent.min().y(), kSquare);
  share.width_ = Index(view.extent.max().x(), kSquare) - share.x_ + 1;
  share.height_ = Index(view.extent.max().y(), kSquare) - share.y_ + 1;
  const int rank = ranks_.at(view.drive);
  for (int y = share.y_; y < share.y_ + share.height_; ++y)
    for (int x = share.x_; x < share.x_ + share.width_; ++x) {
      const auto found = oldest_.find(SquareOf(view, {(x + 0.5) * kSquare, (y + 0.5) * kSquare}));
      share.counts_.push_back(found == oldest_.end() || rank >= found->second);
      share.num_counting_ += share.counts_.back();
    }
  return share;
}

bool LatestDrives::Share::Counts(const Eigen::Vector2d& point_in_site) const {
  if (num_counting_ == width_ * height_) return true;
  const int x = std::clamp(Index(point_in_site.x(), kSquare) - x_, 0, width_ - 1);
  const int y = std::clamp(Index(point_in_site.y(), kSquare) - y_, 0, height_ - 1);
  return counts_[static_cast<size_t>(y * width_ + x)];
}

}  // namespace parkade
