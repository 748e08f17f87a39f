#include "server/ingest/video/video_decoder.h"

#include <cstring>
#include <string_view>
#include <utility>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <libswscale/swscale.h>
}

namespace parkade {
namespace {

constexpr std::int64_t kMaxPixels = std::int64_t{64} << 20;

DecodedImage Damaged(const VideoPacket& packet, const std::string& what) {
  return {{}, ImageFault::kDamaged, packet.CodecName() + " video: " + what};
}

DecodedImage WaitsForKeyFrame(const VideoPacket& packet, const std::string& what) {
  return {{}, ImageFault::kWaitsForKeyFrame, packet.CodecName() + " video: " + what};
}

/// What libavcodec reported while it decoded one packet.
struct Reports {
  bool has_error = false, has_gap = false;
};

/// libavcodec conceals damage and says so only here; a gap in the numbers of frames, which it fills
/// with a copy of the one before, even only at its lowest level.
void OnReport(void* source, int level, const char* format, va_list) {
  if (source == nullptr || *static_cast<const AVClass**>(source) != avcodec_get_class()) return;
  auto* reports = static_cast<Reports*>(static_cast<AVCodecContext*>(source)->opaque);
  if (reports == nullptr) return;
  if (level <= AV_LOG_ERROR) reports->has_error = true;
  if (std::string_view(format).starts_with("Frame num gap")) reports->has_gap = true;
}

}  // namespace

/// libavcodec's state of one video.
class VideoDecoder::Codec {
 public:
  explicit Codec(VideoCodec kind) {
    static const bool is_listening = (av_log_set_callback(OnReport), true);
    static_cast<void>(is_listening);
    const AVCodec* codec =
        avcodec_find_decoder(kind == VideoCodec::kH264 ? AV_CODEC_ID_H264 : AV_CODEC_ID_HEVC);
    if (codec == nullptr) return;
    context_ = avcodec_alloc_context3(codec);
    packet_ = av_packet_alloc();
    frame_ = av_frame_alloc();
    if (context_ == nullptr) return;
    context_->thread_count = 1;  // cameras are decoded side by side
    context_->flags |= AV_CODEC_FLAG_LOW_DELAY;
    context_->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER;
    context_->max_pixels = kMaxPixels;
    context_->opaque = &reports_;
    is_open_ =
        packet_ != nullptr && frame_ != nullptr && avcodec_open2(context_, codec, nullptr) == 0;
  }
  ~Codec() {
    sws_freeContext(scaler_);
    av_frame_free(&frame_);
    av_packet_free(&packet_);
    avcodec_free_context(&context_);
  }
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;

  bool is_open() const { return is_open_; }
  void Forget() { avcodec_flush_buffers(context_); }

  /// Decodes a packet, whose parameter sets are put before it; the fault's words, or none.
  std::string Decode(const VideoPacket& packet, std::span<const std::uint8_t> parameter_sets) {
    reports_ = {};
    padded_.assign(parameter_sets.begin(), parameter_sets.end());
    padded_.insert(padded_.end(), packet.data.begin(), packet.data.end());
    const std::size_t size = padded_.size();
    padded_.resize(size + AV_INPUT_BUFFER_PADDING_SIZE, 0);
    packet_->data = padded_.data();
    packet_->size = static_cast<int>(size);
    packet_->pts = ++number_;
    const int sent = avcodec_send_packet(context_, packet_);
    const int received = avcodec_receive_frame(context_, frame_);
    if (sent == 0 && received == AVERROR(EAGAIN) && !reports_.has_error)
      return "it holds images back: record it without B-frames";
    if (sent < 0 || received < 0) return "damaged data";
    if (frame_->pts != number_) return "it holds images back: record it without B-frames";
    if (reports_.has_gap && !packet.is_key_frame) return "an image before this one is missing";
    if (reports_.has_error || frame_->decode_error_flags != 0 ||
        (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0)
      return "damaged data";
    return "";
  }

  /// The last image decoded, in the form wanted, with black at 0 and white at 255.
  DecodedImage Image(const VideoPacket& packet, const ImageRequest& request) {
    if (auto fault = CheckSize(frame_->width, frame_->height, request)) return *fault;
    const AVPixelFormat format = request.grayscale ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_BGR24;
    scaler_ = sws_getCachedContext(
        scaler_, frame_->width, frame_->height, static_cast<AVPixelFormat>(frame_->format),
        frame_->width, frame_->height, format, SWS_BILINEAR | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT,
        nullptr, nullptr, nullptr);
    if (scaler_ == nullptr) return Damaged(packet, "colors that Parkade does not know");
    const bool is_full_range = frame_->color_range == AVCOL_RANGE_JPEG;
    const int* matrix =
        sws_getCoefficients(frame_->colorspace == AVCOL_SPC_BT709 ? SWS_CS_ITU709 : SWS_CS_DEFAULT);
    constexpr int kOne = 1 << 16;
    sws_setColorspaceDetails(scaler_, matrix, is_full_range, matrix, 1, 0, kOne, kOne);
    DecodedImage decoded;
    decoded.image.create(frame_->height, frame_->width, request.grayscale ? CV_8UC1 : CV_8UC3);
    std::uint8_t* rows[] = {decoded.image.data};
    const int steps[] = {static_cast<int>(decoded.image.step)};
    sws_scale(scaler_, frame_->data, frame_->linesize, 0, frame_->height, rows, steps);
    return decoded;
  }

 private:
  AVCodecContext* context_ = nullptr;
  AVPacket* packet_ = nullptr;
  AVFrame* frame_ = nullptr;
  SwsContext* scaler_ = nullptr;
  Reports reports_;
  std::vector<std::uint8_t> padded_;
  std::int64_t number_ = 0;
  bool is_open_ = false;
};

VideoDecoder::VideoDecoder() = default;
VideoDecoder::~VideoDecoder() = default;

DecodedImage VideoDecoder::Decode(const VideoPacket& packet, const ImageRequest& request) {
  DecodedImage fault = Advance(packet);
  return fault.fault == ImageFault::kNone ? codec_->Image(packet, request) : fault;
}

void VideoDecoder::Skip(const VideoPacket& packet) { Advance(packet); }

void VideoDecoder::Note(const VideoPacket& packet) {
  if (packet.codec == VideoCodec::kOther) return;
  if (codec_ == nullptr || kind_ != packet.codec) {
    codec_ = std::make_unique<Codec>(packet.codec);
    kind_ = packet.codec;
    parameter_sets_.clear();
    fault_ = WaitsForKeyFrame(packet, "no key frame came yet");
  }
  if (!packet.parameter_sets.empty()) parameter_sets_ = packet.parameter_sets;
}

DecodedImage VideoDecoder::Advance(const VideoPacket& packet) {
  if (packet.codec == VideoCodec::kOther)
    return Damaged(packet, "it is not decoded: record H.264, H.265 or JPEG");
  Note(packet);
  if (!codec_->is_open()) return Damaged(packet, "libavcodec of this machine does not decode it");
  if (!packet.has_image)
    return Damaged(packet, packet.parameter_sets.empty()
                               ? "the message holds no image in Annex B form (with start codes)"
                               : "the message holds parameters and no image");
  if (!packet.is_key_frame && fault_.fault != ImageFault::kNone) return fault_;
  if (parameter_sets_.empty())
    return fault_ = WaitsForKeyFrame(packet, "no parameter sets (SPS, PPS) came yet");
  if (packet.is_key_frame) codec_->Forget();
  const bool must_add = packet.is_key_frame && packet.parameter_sets.empty();
  const std::string what =
      codec_->Decode(packet, must_add ? std::span<const std::uint8_t>(parameter_sets_)
                                      : std::span<const std::uint8_t>());
  fault_ = what.empty() ? DecodedImage{} : Damaged(packet, what);
  return fault_;
}

}  // namespace parkade
