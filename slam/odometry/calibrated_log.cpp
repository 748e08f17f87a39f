#include "slam/odometry/calibrated_log.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/error.h"

namespace parkade {
namespace {

/// Shifts images and masks in time, and puts all records in order again.
class ShiftedStream final : public RecordStream {
 public:
  ShiftedStream(std::unique_ptr<RecordStream> stream, const std::vector<double>& shifts)
      : stream_(std::move(stream)), shifts_(shifts) {
    double earliest = 0;
    for (const double shift : shifts) earliest = std::min(earliest, shift);
    look_ahead_ = -earliest;
  }

  std::optional<SensorRecord> Next() override {
    // What is still to come is at most `look_ahead_` earlier than the last record read.
    while (!is_over_ && (waiting_.empty() || last_read_ - TimeOf(waiting_.front()) <= look_ahead_))
      ReadOne();
    if (waiting_.empty()) return std::nullopt;
    SensorRecord record = std::move(waiting_.front());
    waiting_.pop_front();
    return record;
  }

 private:
  void ReadOne() {
    std::optional<SensorRecord> record = stream_->Next();
    is_over_ = !record;
    if (is_over_) return;
    last_read_ = TimeOf(*record);
    if (auto* frame = std::get_if<CameraFrame>(&*record))
      frame->time = frame->time + shifts_[static_cast<size_t>(frame->camera)];
    if (auto* mask = std::get_if<SemanticFrame>(&*record))
      mask->time = mask->time + shifts_[static_cast<size_t>(mask->camera)];
    const auto later = std::upper_bound(
        waiting_.begin(), waiting_.end(), TimeOf(*record),
        [](Timestamp time, const SensorRecord& other) { return time < TimeOf(other); });
    waiting_.insert(later, std::move(*record));
  }

  std::unique_ptr<RecordStream> stream_;
  std::vector<double> shifts_;
  double look_ahead_ = 0;  // [s]
  Timestamp last_read_;
  bool is_over_ = false;
  std::deque<SensorRecord> waiting_;  // in order of time
};

}  // namespace

CalibratedLog::CalibratedLog(const DriveLog& log, Rig rig) : log_(log), rig_(std::move(rig)) {
  Require(rig_.cameras.size() == log.rig().cameras.size(), ErrorCode::kInternal,
          "a calibration must have the cameras of its drive");
  for (size_t i = 0; i < rig_.cameras.size(); ++i)
    shifts_.push_back(rig_.cameras[i].time_shift - log.rig().cameras[i].time_shift);
}

std::unique_ptr<RecordStream> CalibratedLog::Read(const ReadOptions& options) const {
  ReadOptions shifted = options;
  if (options.wants_image)
    shifted.wants_image = [wants = options.wants_image, shifts = shifts_](int camera,
                                                                          Timestamp time) {
      return wants(camera, time + shifts[static_cast<size_t>(camera)]);
    };
  return std::make_unique<ShiftedStream>(log_.Read(shifted), shifts_);
}

}  // namespace parkade
