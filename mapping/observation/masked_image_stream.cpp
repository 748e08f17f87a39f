#include "mapping/observation/masked_image_stream.h"

#include <cmath>
#include <optional>
#include <variant>

namespace parkade {
namespace {

constexpr double kMaskDelay = 0.25;   // [s] of log within which the mask of an image must come
constexpr double kSameImage = 0.002;  // [s] a mask may be stamped this far from its image

bool IsMaskOf(const SemanticFrame& mask, const CameraFrame& frame) {
  return mask.camera == frame.camera && std::abs(mask.time - frame.time) < kSameImage;
}

}  // namespace

std::vector<ImageWithMask> MaskedImageStream::NextBatch(size_t count) {
  std::vector<ImageWithMask> batch;
  while (batch.size() < count && HasNext()) {
    batch.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  return batch;
}

/// Reads on until the first image that waits has its mask, or is past hope of one.
bool MaskedImageStream::HasNext() {
  while (!is_at_end_ &&
         (waiting_.empty() || (waiting_.front().mask.empty() && !IsPastHope(waiting_.front())))) {
    std::optional<SensorRecord> record = stream_->Next();
    if (!record) {
      is_at_end_ = true;
      break;
    }
    last_time_ = TimeOf(*record);
    if (auto* frame = std::get_if<CameraFrame>(&*record)) Add(std::move(*frame));
    if (auto* mask = std::get_if<SemanticFrame>(&*record)) Add(std::move(*mask));
  }
  return !waiting_.empty();
}

bool MaskedImageStream::IsPastHope(const ImageWithMask& image) const {
  return last_time_ - image.frame.time > kMaskDelay;
}

void MaskedImageStream::Add(CameraFrame frame) {
  ImageWithMask image{std::move(frame), {}};
  for (SemanticFrame& mask : early_masks_)
    if (IsMaskOf(mask, image.frame)) image.mask = mask.mask;
  std::erase_if(early_masks_,
                [&](const SemanticFrame& mask) { return last_time_ - mask.time > kMaskDelay; });
  waiting_.push_back(std::move(image));
}

void MaskedImageStream::Add(SemanticFrame mask) {
  for (ImageWithMask& image : waiting_)
    if (IsMaskOf(mask, image.frame)) {
      image.mask = std::move(mask.mask);
      return;
    }
  early_masks_.push_back(std::move(mask));
}

}  // namespace parkade
