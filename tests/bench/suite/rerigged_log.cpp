#include "tests/bench/suite/rerigged_log.h"

#include <numeric>

namespace parkade {
namespace {

/// Gives the cameras their new numbers, and drops those that have none.
class RenumberedStream final : public RecordStream {
 public:
  RenumberedStream(std::unique_ptr<RecordStream> stream, std::vector<int> new_index)
      : stream_(std::move(stream)), new_index_(std::move(new_index)) {}

  std::optional<SensorRecord> Next() override {
    while (std::optional<SensorRecord> record = stream_->Next()) {
      int* camera = nullptr;
      if (auto* frame = std::get_if<CameraFrame>(&*record)) camera = &frame->camera;
      if (auto* mask = std::get_if<SemanticFrame>(&*record)) camera = &mask->camera;
      if (!camera) return record;
      *camera = new_index_[static_cast<size_t>(*camera)];
      if (*camera >= 0) return record;
    }
    return std::nullopt;
  }

 private:
  std::unique_ptr<RecordStream> stream_;
  std::vector<int> new_index_;
};

}  // namespace

ReriggedLog::ReriggedLog(const DriveLog& log, const Rig& rig, std::vector<int> cameras)
    : calibrated_(log, rig),
      cameras_(std::move(cameras)),
      new_index_(rig.cameras.size(), -1),
      rig_(rig) {
  if (cameras_.empty()) {
    cameras_.resize(rig.cameras.size());
    std::iota(cameras_.begin(), cameras_.end(), 0);
  }
  rig_.cameras.clear();
  for (const int camera : cameras_) {
    new_index_[static_cast<size_t>(camera)] = static_cast<int>(rig_.cameras.size());
    rig_.cameras.push_back(rig.cameras[static_cast<size_t>(camera)]);
  }
}

std::unique_ptr<RecordStream> ReriggedLog::Read(const ReadOptions& options) const {
  ReadOptions renumbered = options;
  renumbered.wants_image = [wants = options.wants_image, index = new_index_](int camera,
                                                                             Timestamp time) {
    const int mine = index[static_cast<size_t>(camera)];
    return mine >= 0 && (!wants || wants(mine, time));
  };
  return std::make_unique<RenumberedStream>(calibrated_.Read(renumbered), new_index_);
}

}  // namespace parkade
