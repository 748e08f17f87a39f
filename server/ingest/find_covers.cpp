#include <algorithm>
#include <cmath>

#include "server/ingest/picture_history.h"

namespace parkade {
namespace {

using Blocks = PictureSample::Blocks;

constexpr double kBegins = 0.2, kLasts = 0.12;  // share of the picture beyond what is usual
constexpr double kSameBlocks = 0.5;             // of the blocks that are blind in one of two samples, in both
constexpr int kLeastPairs = 3;                  // of samples between which the car moved
constexpr double kShortest = 3;                 // [s]

double Share(const Blocks& some, const Blocks& of) {
  return of.any() ? static_cast<double>((some & of).count()) / static_cast<double>(of.count()) : 0;
}

/// The value that this share of all is at or below; 0 of none.
double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Blocks that are more than black at some time: those within the lens.
Blocks LitBlocks(const PictureHistory& camera) {
  constexpr int kBlack = 12;
  Blocks lit;
  for (const PictureHistory::Entry& entry : camera.entries())
    for (std::size_t i = 0; i < PictureSample::kBlocks; ++i)
      if (entry.sample.brightness[i] >= kBlack) lit.set(i);
  return lit;
}

std::vector<double> BlindShares(const PictureHistory& camera, const Blocks& lit) {
  std::vector<double> shares;
  for (const PictureHistory::Entry& entry : camera.entries()) shares.push_back(Share(entry.sample.blind, lit));
  return shares;
}

/// Whether what can be seen has changed, other than as a whole.
bool HasMoved(const PictureSample& before, const PictureSample& after, const Blocks& lit) {
  constexpr double kChange = 4, kMovedShare = 0.25;  // grey levels; of the blocks
  constexpr std::size_t kLeastBlocks = 8;
  const Blocks seeing = lit & ~(before.blind | after.blind);
  if (seeing.count() < kLeastBlocks) return false;
  std::vector<double> changes;
  for (std::size_t i = 0; i < PictureSample::kBlocks; ++i)
    if (seeing[i]) changes.push_back(static_cast<double>(after.brightness[i]) - before.brightness[i]);
  const double common = Quantile(changes, 0.5);
  const auto num_moved =
      std::count_if(changes.begin(), changes.end(), [&](double change) { return std::abs(change - common) > kChange; });
  return static_cast<double>(num_moved) > kMovedShare * static_cast<double>(changes.size());
}

/// One camera's samples against what is usual.
class CoverFinder {
 public:
  /// `moments`, sorted: when some camera saw the world move.
  CoverFinder(const Blocks& lit, double usual_share, const std::vector<Timestamp>& moments)
      : lit_(lit), usual_share_(usual_share), moments_(moments) {}

  void IncludePair(const PictureHistory::Entry& before, const PictureHistory::Entry& after) {
    const Blocks both = before.sample.blind & after.sample.blind & lit_,
                 any = (before.sample.blind | after.sample.blind) & lit_;
    const double share = Share(both, lit_);
    const bool is_covered =
        share - usual_share_ > (num_pairs_ > 0 ? kLasts : kBegins) && Share(both, any) > kSameBlocks;
    if (!is_covered) return Close();
    if (num_pairs_++ == 0) fault_ = {PictureFault::Kind::kCovered, before.time, after.time, 0};
    fault_.end = std::max(fault_.end, after.time);
    fault_.share += share;
    const auto next = std::upper_bound(moments_.begin(), moments_.end(), before.time);
    num_moving_ += next != moments_.end() && *next <= after.time;
  }

  std::vector<PictureFault> Finish() {
    Close();
    return std::move(faults_);
  }

 private:
  void Close() {
    fault_.share /= std::max(1, num_pairs_);
    const bool is_fault = num_moving_ >= kLeastPairs && fault_.Seconds() >= kShortest;
    num_pairs_ = num_moving_ = 0;
    if (!is_fault) return;
    // A picture or two may show more, as where the sun shines through the mud.
    const bool goes_on = !faults_.empty() && fault_.begin.ToSeconds() - faults_.back().end.ToSeconds() <= kShortest;
    if (goes_on)
      faults_.back().end = fault_.end;
    else if (faults_.size() < PictureHistory::kMaxFaults)
      faults_.push_back(fault_);
  }

  const Blocks lit_;
  const double usual_share_;
  const std::vector<Timestamp>& moments_;
  PictureFault fault_;
  int num_pairs_ = 0, num_moving_ = 0;
  std::vector<PictureFault> faults_;
};

}  // namespace

std::vector<std::vector<PictureFault>> FindCovers(const std::vector<const PictureHistory*>& cameras) {
  std::vector<Blocks> lit;
  std::vector<double> medians, low;  // of the blind shares
  std::vector<Timestamp> moments;
  for (const PictureHistory* camera : cameras) {
    lit.push_back(LitBlocks(*camera));
    const std::vector<double> shares = BlindShares(*camera, lit.back());
    medians.push_back(Quantile(shares, 0.5));
    low.push_back(Quantile(shares, 0.25));
    const auto& entries = camera->entries();
    for (std::size_t i = 1; i < entries.size(); ++i)
      if (HasMoved(entries[i - 1].sample, entries[i].sample, lit.back())) moments.push_back(entries[i].time);
  }
  std::sort(moments.begin(), moments.end());
  std::vector<std::vector<PictureFault>> covers;
  for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
    std::vector<double> others;
    for (std::size_t other = 0; other < cameras.size(); ++other)
      if (other != camera && !cameras[other]->entries().empty()) others.push_back(medians[other]);
    const double usual = others.empty() ? low[camera] : std::min(low[camera], Quantile(others, 0.5));
    CoverFinder finder(lit[camera], usual, moments);
    const auto& entries = cameras[camera]->entries();
    for (std::size_t i = 1; i < entries.size(); ++i) finder.IncludePair(entries[i - 1], entries[i]);
    covers.push_back(finder.Finish());
  }
  return covers;
}

}  // namespace parkade
