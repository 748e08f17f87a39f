#include "mapping/texture/photo_reader.h"

#include <optional>

namespace parkade {

PhotoReader::PhotoReader(const DriveLog& log, const PhotoChoice& choice)
    : choice_(&choice),
      stream_(log.Read(
          {.imu = false,
           .wheels = false,
           .gnss = false,
           .images = true,
           .semantics = false,
           .grayscale = false,
           .wants_image = [&choice](int camera, Timestamp time) { return choice.contains(std::pair(camera, time)); }})),
      num_left_(choice.size()) {}

std::vector<GroundPhoto> PhotoReader::Next() {
  constexpr std::size_t kPhotosPerBatch = 16;  // in memory at once
  std::vector<GroundPhoto> photos;
  while (photos.size() < kPhotosPerBatch && num_left_ > 0) {
    std::optional<SensorRecord> record = stream_->Next();
    if (!record) break;
    const auto* frame = std::get_if<CameraFrame>(&*record);
    if (frame == nullptr) continue;
    const auto chosen = choice_->find({frame->camera, frame->time});
    if (chosen == choice_->end()) continue;
    photos.push_back(chosen->second);
    photos.back().image = frame->image;
    --num_left_;
  }
  return photos;
}

}  // namespace parkade
