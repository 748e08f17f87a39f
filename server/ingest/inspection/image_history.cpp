#include "server/ingest/inspection/image_history.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr int kDarkBelow = 56;                                 // gray level
constexpr double kShortestDark = 0.2, kShortestUnchanged = 2;  // [s]

double ShortestOf(CameraFault::Kind kind) {
  return kind == CameraFault::Kind::kDark ? kShortestDark : kShortestUnchanged;
}

}  // namespace

const char* NameOf(CameraFault::Kind kind) {
  switch (kind) {
    case CameraFault::Kind::kDark: return "dark";
    case CameraFault::Kind::kUnchanged: return "unchanged";
    case CameraFault::Kind::kCovered: break;
  }
  return "covered";
}

bool ImageHistory::WantsSample(Timestamp time) {
  const bool is_due = !last_sampled_ || time < *last_sampled_ ||
                      time.ToSeconds() - last_sampled_->ToSeconds() >= interval_;
  if (is_due) last_sampled_ = time;
  return is_due;
}

void ImageHistory::Include(Timestamp time, const ImageGlance& glance,
                           const std::optional<ImageSample>& sample) {
  const bool is_dark = glance.brightest < kDarkBelow;
  if (is_dark)
    dark_.Include(time);
  else
    Close(dark_, CameraFault::Kind::kDark);
  if (is_dark || glance.content != last_content_) Close(unchanged_, CameraFault::Kind::kUnchanged);
  if (!is_dark) unchanged_.Include(time);
  last_content_ = glance.content;
  if (is_dark || !sample) return;
  entries_.push_back({time, *sample});
  if (entries_.size() < kMaxSamples) return;
  for (std::size_t i = 0; 2 * i < entries_.size(); ++i) entries_[i] = entries_[2 * i];
  entries_.resize((entries_.size() + 1) / 2);
  interval_ *= 2;
}

void ImageHistory::Close(TimeSpan& run, CameraFault::Kind kind) {
  const CameraFault fault{kind, run.begin, run.end, 1};
  const auto num_known = std::count_if(faults_.begin(), faults_.end(),
                                       [&](const auto& known) { return known.kind == kind; });
  if (!run.IsEmpty() && fault.Seconds() >= ShortestOf(kind) &&
      num_known < static_cast<std::ptrdiff_t>(kMaxFaults))
    faults_.push_back(fault);
  run = {};
}

std::vector<CameraFault> ImageHistory::Faults() const {
  ImageHistory finished;
  finished.faults_ = faults_;
  finished.dark_ = dark_;
  finished.unchanged_ = unchanged_;
  finished.Close(finished.dark_, CameraFault::Kind::kDark);
  finished.Close(finished.unchanged_, CameraFault::Kind::kUnchanged);
  std::sort(finished.faults_.begin(), finished.faults_.end(),
            [](const CameraFault& a, const CameraFault& b) { return a.begin < b.begin; });
  return finished.faults_;
}

}  // namespace parkade
