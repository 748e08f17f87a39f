#include "server/ingest/video/video_packet.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "server/ingest/messages/image_decoding.h"

namespace parkade {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 4> kStartCode = {0, 0, 0, 1};

/// Whether bytes begin with a start code of three or four bytes.
bool BeginsWithStartCode(Bytes data) {
  const auto code = std::span(kStartCode);
  return data.size() > code.size() && (std::ranges::equal(data.first(4), code) ||
                                       std::ranges::equal(data.first(3), code.subspan(1)));
}

/// The units between start codes.
std::vector<Bytes> UnitsOf(Bytes data) {
  const auto code = std::span(kStartCode).subspan(1);
  std::vector<Bytes> units;
  auto at = std::search(data.begin(), data.end(), code.begin(), code.end());
  while (at != data.end()) {
    const auto begin = at + static_cast<std::ptrdiff_t>(code.size());
    at = std::search(begin, data.end(), code.begin(), code.end());
    if (begin != at) units.emplace_back(begin, at);
  }
  return units;
}

int TypeOf(Bytes unit, VideoCodec codec) {
  return codec == VideoCodec::kH264 ? unit[0] & 0x1f : unit[0] >> 1 & 0x3f;
}

bool IsParameterSet(int type, VideoCodec codec) {
  return codec == VideoCodec::kH264 ? type == 7 || type == 8 : type >= 32 && type <= 34;
}

bool IsImage(int type, VideoCodec codec) {
  return codec == VideoCodec::kH264 ? type >= 1 && type <= 5 : type <= 21;
}

/// Images behind which nothing refers to what came before: IDR of H.264, IRAP of H.265.
bool IsKeyFrame(int type, VideoCodec codec) {
  return codec == VideoCodec::kH264 ? type == 5 : type >= 16 && type <= 21;
}

/// Whether supplemental information of H.264 says that decoding may begin with this image, which
/// encoders without IDR frames do. H.264, D.1.8: recovery_frame_cnt is 0.
bool IsRecoveryPoint(Bytes unit) {
  constexpr int kSupplemental = 6;
  constexpr std::size_t kRecoveryPoint = 6;
  if (TypeOf(unit, VideoCodec::kH264) != kSupplemental) return false;
  std::size_t at = 1;
  const auto read_number = [&] {  // bytes of 255 go on
    std::size_t sum = 0;
    while (at < unit.size() && unit[at] == 0xff) sum += unit[at++];
    return at < unit.size() ? sum + unit[at++] : sum;
  };
  while (at + 2 < unit.size()) {
    const std::size_t type = read_number(), size = read_number();
    if (type == kRecoveryPoint) return at < unit.size() && (unit[at] & 0x80) != 0;
    at += size;
  }
  return false;
}

/// What the sender calls H.264 and H.265, or else what the first unit looks like: that of H.265 has
/// two bytes of header, the second 1, and types that H.264 does not have with such a byte.
VideoCodec CodecOf(const std::string& format, Bytes data) {
  if (format.find("265") != std::string::npos || format.find("hevc") != std::string::npos)
    return VideoCodec::kH265;
  if (format.find("264") != std::string::npos || format.find("avc") != std::string::npos)
    return VideoCodec::kH264;
  if (!BeginsWithStartCode(data)) return VideoCodec::kOther;
  const std::vector<Bytes> units = UnitsOf(data);
  if (units.empty() || units.front().size() < 2) return VideoCodec::kOther;
  constexpr std::array<std::uint8_t, 10> kTypes = {0, 1, 19, 20, 21, 32, 33, 34, 35, 39};
  const Bytes unit = units.front();
  const bool is_h265 = (unit[0] & 0x81) == 0 && unit[1] == 1 &&
                       std::ranges::find(kTypes, unit[0] >> 1) != kTypes.end();
  return is_h265 ? VideoCodec::kH265 : VideoCodec::kH264;
}

}  // namespace

std::string VideoPacket::CodecName() const {
  switch (codec) {
    case VideoCodec::kH264: return "H.264";
    case VideoCodec::kH265: return "H.265";
    case VideoCodec::kOther: break;
  }
  return "'" + format + "'";
}

std::optional<VideoPacket> AsVideoPacket(std::string_view format, Bytes data) {
  if (IsJpeg(data) || IsPng(data)) return std::nullopt;
  VideoPacket packet;
  packet.format = format.substr(0, 40);
  for (char& c : packet.format) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  constexpr std::array<const char*, 5> kOthers = {"vp8", "vp9", "av1", "mpeg4", "theora"};
  const bool is_other = std::ranges::any_of(
      kOthers, [&](const char* name) { return packet.format.find(name) != std::string::npos; });
  packet.codec = is_other ? VideoCodec::kOther : CodecOf(packet.format, data);
  if (packet.codec == VideoCodec::kOther && !is_other) return std::nullopt;
  packet.data.assign(data.begin(), data.end());
  if (is_other) return packet;
  for (const Bytes unit : UnitsOf(packet.data)) {
    const int type = TypeOf(unit, packet.codec);
    packet.has_image = packet.has_image || IsImage(type, packet.codec);
    packet.is_key_frame = packet.is_key_frame || IsKeyFrame(type, packet.codec) ||
                          (packet.codec == VideoCodec::kH264 && IsRecoveryPoint(unit));
    if (!IsParameterSet(type, packet.codec)) continue;
    packet.parameter_sets.insert(packet.parameter_sets.end(), kStartCode.begin(), kStartCode.end());
    packet.parameter_sets.insert(packet.parameter_sets.end(), unit.begin(), unit.end());
  }
  packet.is_key_frame = packet.is_key_frame && packet.has_image;
  return packet;
}

}  // namespace parkade
