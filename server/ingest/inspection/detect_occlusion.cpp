#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "core/math/statistics.h"
#include "server/ingest/inspection/image_history.h"

namespace parkade {
namespace {

using Blocks = std::bitset<ImageSample::kBlocks>;
using Contrasts = std::array<double, ImageSample::kBlocks>;  // in units of ImageSample

constexpr double kBegins = 0.2, kLasts = 0.12;  // share of the image that is blind beyond the usual
constexpr double kSameBlocks = 0.5;  // of the blocks that are blind in one of two samples, in both
constexpr double kAlways = 0.8;      // share of the samples in which a covered block is blind
constexpr int kLeastPairs = 5;       // of samples between which the car moved
constexpr double kShortest = 3;      // [s]

double Share(const Blocks& some, const Blocks& of) {
  return of.any() ? static_cast<double>((some & of).count()) / static_cast<double>(of.count()) : 0;
}

/// The value that this share of all is at or below; 0 without any.
double LowerQuantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  return NthSmallest(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1)));
}

/// The blocks within the lens: those that are more than black at some time.
Blocks LitBlocks(const ImageHistory& camera) {
  constexpr int kBlack = 12;
  Blocks lit;
  for (const ImageHistory::Entry& entry : camera.entries())
    for (std::size_t i = 0; i < ImageSample::kBlocks; ++i)
      if (entry.sample.brightness[i] >= kBlack) lit.set(i);
  return lit;
}

/// This quantile over time of each block's contrast.
Contrasts ContrastsOf(const ImageHistory& camera, double quantile) {
  Contrasts contrasts{};
  for (std::size_t i = 0; i < ImageSample::kBlocks; ++i) {
    std::vector<double> values;
    for (const ImageHistory::Entry& entry : camera.entries())
      values.push_back(entry.sample.contrast[i]);
    contrasts[i] = LowerQuantile(std::move(values), quantile);
  }
  return contrasts;
}

/// The contrast that a camera usually shows at each height in the image.
std::array<double, ImageSample::kRows> ContrastOfRows(const ImageHistory& camera,
                                                      const Blocks& lit) {
  const Contrasts usual = ContrastsOf(camera, 0.5);
  std::array<double, ImageSample::kRows> rows{};
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::vector<double> values;
    for (std::size_t i = row * ImageSample::kColumns; i < (row + 1) * ImageSample::kColumns; ++i)
      if (lit[i]) values.push_back(usual[i]);
    rows[row] = LowerQuantile(std::move(values), 0.5);
  }
  return rows;
}

Blocks BlindBlocks(const ImageSample& sample, const Contrasts& expected, const Blocks& lit) {
  constexpr double kBlind = 0.4;  // of the contrast that is expected
  Blocks blind;
  for (std::size_t i = 0; i < ImageSample::kBlocks; ++i)
    blind[i] = lit[i] && sample.contrast[i] <= kBlind * expected[i];
  return blind;
}

/// Whether the view has changed, other than as a whole.
bool HasMoved(const ImageSample& before, const ImageSample& after, const Blocks& lit) {
  constexpr double kChange = 4, kMovedShare = 0.25;  // gray levels; of the blocks
  constexpr std::size_t kLeastBlocks = 8;
  constexpr std::uint8_t kSeeing = 10;  // contrast
  std::vector<double> changes;
  for (std::size_t i = 0; i < ImageSample::kBlocks; ++i)
    if (lit[i] && std::min(before.contrast[i], after.contrast[i]) >= kSeeing)
      changes.push_back(static_cast<double>(after.brightness[i]) - before.brightness[i]);
  if (changes.size() < kLeastBlocks) return false;
  const double common = LowerQuantile(changes, 0.5);
  const auto num_moved = std::count_if(changes.begin(), changes.end(), [&](double change) {
    return std::abs(change - common) > kChange;
  });
  return static_cast<double>(num_moved) > kMovedShare * static_cast<double>(changes.size());
}

/// One camera's samples against the usual contrast.
class CoverFinder {
 public:
  /// `moments`, sorted: when some camera saw the world move.
  CoverFinder(const Blocks& lit, double usual_share, const std::vector<Timestamp>& moments)
      : lit_(lit), usual_share_(usual_share), moments_(moments) {}

  /// Two samples that follow each other, and what is blind in them.
  void IncludePair(Timestamp before, const Blocks& blind_before, Timestamp after,
                   const Blocks& blind_after) {
    const Blocks both = blind_before & blind_after;
    const double share = Share(both, lit_);
    const bool is_covered = share - usual_share_ > (num_pairs_ > 0 ? kLasts : kBegins) &&
                            Share(both, blind_before | blind_after) > kSameBlocks;
    if (!is_covered) return Close();
    if (num_pairs_++ == 0) fault_ = {CameraFault::Kind::kCovered, before, after, 0};
    fault_.end = std::max(fault_.end, after);
    fault_.share += share;
    for (std::size_t i = 0; i < both.size(); ++i) num_blind_[i] += both[i];
    const auto next = std::upper_bound(moments_.begin(), moments_.end(), before);
    num_moving_ += next != moments_.end() && *next <= after;
  }

  std::vector<CameraFault> Finish() {
    Close();
    return std::move(faults_);
  }

 private:
  void Close() {
    Blocks always;
    for (std::size_t i = 0; i < always.size(); ++i)
      always[i] = num_blind_[i] > kAlways * num_pairs_;
    fault_.share /= std::max(1, num_pairs_);
    const bool is_fault = num_moving_ >= kLeastPairs && fault_.Seconds() >= kShortest &&
                          Share(always, lit_) > kBegins;
    num_pairs_ = num_moving_ = 0;
    num_blind_ = {};
    if (!is_fault) return;
    // An image or two may show more, as where the sun shines through the mud.
    const bool goes_on =
        !faults_.empty() && fault_.begin.ToSeconds() - faults_.back().end.ToSeconds() <= kShortest;
    if (goes_on)
      faults_.back().end = fault_.end;
    else if (faults_.size() < ImageHistory::kMaxFaults)
      faults_.push_back(fault_);
  }

  const Blocks lit_;
  const double usual_share_;
  const std::vector<Timestamp>& moments_;
  CameraFault fault_;
  int num_pairs_ = 0, num_moving_ = 0;
  std::array<int, ImageSample::kBlocks> num_blind_{};
  std::vector<CameraFault> faults_;
};

/// The usual contrasts that a camera's samples are compared with.
struct CameraView {
  const ImageHistory* history = nullptr;
  Blocks lit;
  std::array<double, ImageSample::kRows> rows{};  // usual contrast
  std::vector<Blocks> blind;                      // of each sample
  std::vector<double>
      shares;  // share of the lit blocks, blind in two samples that follow each other
};

/// The median of the views other than `view` that have samples; nothing without any.
template <typename ValueOf>
std::optional<double> MedianOfOthers(const std::vector<CameraView>& views, const CameraView& view,
                                     ValueOf value_of) {
  std::vector<double> values;
  for (const CameraView& other : views)
    if (&other != &view && !other.history->entries().empty()) values.push_back(value_of(other));
  if (values.empty()) return std::nullopt;
  return LowerQuantile(std::move(values), 0.5);
}

void FindBlindBlocks(const std::vector<CameraView>& views, CameraView& view) {
  constexpr double kAtItsBest = 0.9;
  Contrasts expected = ContrastsOf(*view.history, kAtItsBest);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t row = i / ImageSample::kColumns;
    const auto others =
        MedianOfOthers(views, view, [&](const CameraView& other) { return other.rows[row]; });
    expected[i] = std::max(expected[i], others.value_or(0));
  }
  for (const ImageHistory::Entry& entry : view.history->entries())
    view.blind.push_back(BlindBlocks(entry.sample, expected, view.lit));
  for (std::size_t i = 1; i < view.blind.size(); ++i)
    view.shares.push_back(Share(view.blind[i - 1] & view.blind[i], view.lit));
}

std::vector<Timestamp> MomentsOfMotion(const std::vector<CameraView>& views) {
  std::vector<Timestamp> moments;
  for (const CameraView& view : views) {
    const auto& entries = view.history->entries();
    for (std::size_t i = 1; i < entries.size(); ++i)
      if (HasMoved(entries[i - 1].sample, entries[i].sample, view.lit))
        moments.push_back(entries[i].time);
  }
  std::sort(moments.begin(), moments.end());
  return moments;
}

}  // namespace

std::vector<std::vector<CameraFault>> DetectOcclusion(
    const std::vector<const ImageHistory*>& cameras) {
  std::vector<CameraView> views;
  for (const ImageHistory* camera : cameras) {
    const Blocks lit = LitBlocks(*camera);
    views.push_back({camera, lit, ContrastOfRows(*camera, lit), {}, {}});
  }
  for (CameraView& view : views) FindBlindBlocks(views, view);

  const std::vector<Timestamp> moments = MomentsOfMotion(views);
  std::vector<std::vector<CameraFault>> covers;
  for (const CameraView& view : views) {
    const double low = LowerQuantile(view.shares, 0.25);
    const auto others = MedianOfOthers(
        views, view, [](const CameraView& other) { return LowerQuantile(other.shares, 0.5); });
    CoverFinder finder(view.lit, std::min(low, others.value_or(low)), moments);
    const auto& entries = view.history->entries();
    for (std::size_t i = 1; i < entries.size(); ++i)
      finder.IncludePair(entries[i - 1].time, view.blind[i - 1], entries[i].time, view.blind[i]);
    covers.push_back(finder.Finish());
  }
  return covers;
}

}  // namespace parkade
