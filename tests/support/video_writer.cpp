#include "tests/support/video_writer.h"

#include <memory>

#include "core/error.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

namespace parkade {
namespace {

constexpr const char* kWhat = "the test's video cannot be encoded";

struct Release {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

std::unique_ptr<AVCodecContext, Release> OpenEncoder(const cv::Mat& image,
                                                     const VideoWriterOptions& options) {
  const AVCodec* encoder = avcodec_find_encoder_by_name(options.encoder.c_str());
  Require(encoder != nullptr, ErrorCode::kInternal, kWhat);
  std::unique_ptr<AVCodecContext, Release> context(avcodec_alloc_context3(encoder));
  context->width = image.cols;
  context->height = image.rows;
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->color_range = options.is_full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  context->time_base = {1, 10};
  context->gop_size = options.key_frame_interval;
  context->max_b_frames = options.num_b_frames;
  context->thread_count = 1;
  const std::string bframes = "bframes=" + std::to_string(options.num_b_frames);
  const std::string repeats = options.repeats_parameters ? "1" : "0";
  av_opt_set(context->priv_data, "crf", std::to_string(options.rate_factor).c_str(), 0);
  if (options.encoder == "libx265")
    av_opt_set(context->priv_data, "x265-params",
               ("log-level=none:pools=none:frame-threads=1:repeat-headers=" + repeats + ":" +
                bframes + ":keyint=" + std::to_string(options.key_frame_interval))
                   .c_str(),
               0);
  else
    av_opt_set(context->priv_data, "x264-params", ("repeat-headers=" + repeats).c_str(), 0);
  // Without them in the packets, the encoder hands the parameters out once.
  if (!options.repeats_parameters) context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  Require(avcodec_open2(context.get(), encoder, nullptr) == 0, ErrorCode::kInternal, kWhat);
  return context;
}

/// The image as luma of a frame without color.
std::unique_ptr<AVFrame, Release> FrameOf(const cv::Mat& image, const AVCodecContext& context) {
  std::unique_ptr<AVFrame, Release> frame(av_frame_alloc());
  frame->width = image.cols;
  frame->height = image.rows;
  frame->format = context.pix_fmt;
  frame->color_range = context.color_range;
  Require(av_frame_get_buffer(frame.get(), 0) == 0, ErrorCode::kInternal, kWhat);
  const bool is_full_range = context.color_range == AVCOL_RANGE_JPEG;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const int gray = image.at<std::uint8_t>(y, x);
      frame->data[0][y * frame->linesize[0] + x] =
          static_cast<std::uint8_t>(is_full_range ? gray : 16 + (gray * 219 + 127) / 255);
    }
  for (const int plane : {1, 2})
    for (int y = 0; y < (image.rows + 1) / 2; ++y)
      std::fill_n(frame->data[plane] + y * frame->linesize[plane], (image.cols + 1) / 2,
                  std::uint8_t{128});
  return frame;
}

}  // namespace

std::vector<std::vector<std::uint8_t>> EncodeVideo(const std::vector<cv::Mat>& images,
                                                   const VideoWriterOptions& options) {
  av_log_set_level(AV_LOG_QUIET);
  const auto context = OpenEncoder(images.front(), options);
  const std::unique_ptr<AVPacket, Release> packet(av_packet_alloc());
  std::vector<std::vector<std::uint8_t>> packets;
  const auto collect = [&] {
    while (avcodec_receive_packet(context.get(), packet.get()) == 0) {
      packets.emplace_back(packet->data, packet->data + packet->size);
      av_packet_unref(packet.get());
    }
  };
  for (const cv::Mat& image : images) {
    const auto frame = FrameOf(image, *context);
    frame->pts = &image - images.data();
    Require(avcodec_send_frame(context.get(), frame.get()) == 0, ErrorCode::kInternal, kWhat);
    collect();
  }
  avcodec_send_frame(context.get(), nullptr);
  collect();
  Require(packets.size() == images.size(), ErrorCode::kInternal, kWhat);
  if (!options.repeats_parameters)
    packets.front().insert(packets.front().begin(), context->extradata,
                           context->extradata + context->extradata_size);
  return packets;
}

}  // namespace parkade
