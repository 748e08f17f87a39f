#include "mapping/texture/image_reader.h"

#include <optional>

namespace parkade {

ImageReader::ImageReader(const DriveLog& log, const ImageChoice& choice)
    : choice_(&choice),
      stream_(log.Read({.imu = false,
                        .wheels = false,
                        .gnss = false,
                        .images = true,
                        .semantics = false,
                        .grayscale = false,
                        .wants_image =
                            [&choice](int camera, Timestamp time) {
                              return choice.contains(std::pair(camera, time));
                            }})),
      num_left_(choice.size()) {}

std::vector<GroundImage> ImageReader::Next() {
  constexpr std::size_t kImagesPerBatch = 16;  // in memory at once
  std::vector<GroundImage> images;
  while (images.size() < kImagesPerBatch && num_left_ > 0) {
    std::optional<SensorRecord> record = stream_->Next();
    if (!record) break;
    const auto* frame = std::get_if<CameraFrame>(&*record);
    if (frame == nullptr) continue;
    const auto chosen = choice_->find({frame->camera, frame->time});
    if (chosen == choice_->end()) continue;
    images.push_back(chosen->second);
    images.back().image = frame->image;
    --num_left_;
  }
  return images;
}

}  // namespace parkade
