#include "server/ingest/video/video_track.h"

#include <utility>

namespace parkade {
namespace {

constexpr std::size_t kMaxWaitingBytes = 16 << 20;

/// Whether anybody but the track may ask for the frame.
bool IsHeld(const std::shared_ptr<VideoFrame>& frame) { return frame.use_count() > 1; }

}  // namespace

std::shared_ptr<VideoFrame> VideoTrack::Add(VideoPacket packet) {
  const std::lock_guard lock(mutex_);
  num_waiting_bytes_ += packet.data.size();
  auto frame = std::make_shared<VideoFrame>(VideoFrame{std::move(packet), {}, false});
  waiting_.push_back(frame);
  if (frame->packet.is_key_frame) DropUnheldGroups();
  DecodeUnheldBeyondLimit();
  return frame;
}

void VideoTrack::DropUnheldGroups() {
  std::size_t num_dropped = 0;
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    if (waiting_[i]->packet.is_key_frame) num_dropped = i;
    if (IsHeld(waiting_[i])) break;
  }
  for (; num_dropped > 0; --num_dropped) decoder_.Note(TakeFirst()->packet);
}

void VideoTrack::DecodeUnheldBeyondLimit() {
  while (num_waiting_bytes_ > kMaxWaitingBytes && !IsHeld(waiting_.front()))
    decoder_.Skip(TakeFirst()->packet);
}

std::shared_ptr<VideoFrame> VideoTrack::TakeFirst() {
  std::shared_ptr<VideoFrame> frame = std::move(waiting_.front());
  waiting_.pop_front();
  num_waiting_bytes_ -= frame->packet.data.size();
  return frame;
}

DecodedImage VideoTrack::Decode(const std::shared_ptr<VideoFrame>& frame,
                                const ImageRequest& request) {
  const std::lock_guard lock(mutex_);
  while (!frame->is_decoded) {
    const std::shared_ptr<VideoFrame> first = TakeFirst();
    if (IsHeld(first))
      first->decoded = decoder_.Decode(first->packet, request);
    else
      decoder_.Skip(first->packet);
    first->packet = {};
    first->is_decoded = true;
  }
  return frame->decoded;
}

}  // namespace parkade
