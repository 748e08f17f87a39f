#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "server/ingest/messages/decoded_image.h"
#include "server/ingest/video/video_decoder.h"
#include "server/ingest/video/video_packet.h"

namespace parkade {

/// One image of a video. What it holds belongs to its track.
struct VideoFrame {
  VideoPacket packet;  ///< empty once decoded
  DecodedImage decoded;
  bool is_decoded = false;
};

/// The video of one camera in one pass over a log. All its messages are added in the order of the
/// log; any of the images may be asked for, in about that order and from any thread. An image needs
/// those before it, up to a key frame: they are decoded by who asks first for one behind them, and
/// groups of images that nobody holds are passed over.
///
/// The mutex is DecodeAhead's affair: its workers decode the cameras side by side, and images of
/// one camera one after another.
class VideoTrack {
 public:
  /// \return  a handle; its owner may drop it unasked
  std::shared_ptr<VideoFrame> Add(VideoPacket packet);

  /// Decodes a frame of this track; asked again, it is the same image, as first requested.
  DecodedImage Decode(const std::shared_ptr<VideoFrame>& frame, const ImageRequest& request);

 private:
  void DropUnheldGroups();
  /// Bounds the memory of a video that has hardly any key frames.
  void DecodeUnheldBeyondLimit();
  std::shared_ptr<VideoFrame> TakeFirst();

  std::mutex mutex_;                                 ///< guards all below, and the frames
  std::deque<std::shared_ptr<VideoFrame>> waiting_;  ///< not decoded yet, in order
  std::size_t num_waiting_bytes_ = 0;
  VideoDecoder decoder_;
};

}  // namespace parkade
