#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace parkade {

enum class VideoCodec { kH264, kH265, kOther };

/// One message of a video, as far as can be said without decoding it. ITU-T H.264 and H.265,
/// 7.3.1 and 7.4.1; Annex B.
struct VideoPacket {
  VideoCodec codec = VideoCodec::kOther;
  std::string format;              ///< as the sender has it, at most 40 characters
  std::vector<std::uint8_t> data;  ///< with start codes
  bool has_image = false;
  bool is_key_frame = false;  ///< can be decoded without what came before, but for parameter sets
  /// What describes the video, with start codes; empty where it came before.
  std::vector<std::uint8_t> parameter_sets;

  /// As people call the codec.
  std::string CodecName() const;
};

/// The data of a message as a packet of video, or nothing where they are JPEG, PNG or anything
/// else. `format`: as the sender has it.
std::optional<VideoPacket> AsVideoPacket(std::string_view format,
                                         std::span<const std::uint8_t> data);

}  // namespace parkade
