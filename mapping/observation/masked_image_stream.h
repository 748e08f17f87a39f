#pragma once

#include <deque>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <utility>
#include <vector>

#include "core/drive_log.h"

namespace parkade {

/// An image and what the log's own mask says of it.
struct ImageWithMask {
  CameraFrame frame;
  cv::Mat mask;  ///< empty where the log has none
};

/// Joins images with their masks, which may come before or after them.
class MaskedImageStream {
 public:
  explicit MaskedImageStream(std::unique_ptr<RecordStream> stream) : stream_(std::move(stream)) {}

  /// The next images in order of time, up to `count`; fewer only at the end.
  std::vector<ImageWithMask> NextBatch(size_t count);

 private:
  bool HasNext();
  bool IsPastHope(const ImageWithMask& image) const;
  void Add(CameraFrame frame);
  void Add(SemanticFrame mask);

  std::unique_ptr<RecordStream> stream_;
  std::deque<ImageWithMask> waiting_;
  std::vector<SemanticFrame> early_masks_;
  Timestamp last_time_{};
  bool is_at_end_ = false;
};

}  // namespace parkade
