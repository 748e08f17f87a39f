#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace parkade {

struct VideoWriterOptions {
  std::string encoder = "libx264";  ///< or "libx265", as libavcodec calls them
  int key_frame_interval = 10;      ///< images
  int num_b_frames = 0;
  int rate_factor = 12;            ///< constant; 23 is what encoders take by themselves
  bool repeats_parameters = true;  ///< false: they come with the first key frame alone
  bool is_full_range = true;       ///< black is 0 and white 255, else 16 and 235
};

inline VideoWriterOptions WithEncoder(const std::string& encoder) {
  VideoWriterOptions options;
  options.encoder = encoder;
  return options;
}

/// Encodes images (CV_8UC1, of one even size) with libavcodec as Annex B: one packet each, in the
/// order of decoding. Throws Error{kInternal} where the encoder is not there.
std::vector<std::vector<std::uint8_t>> EncodeVideo(const std::vector<cv::Mat>& images,
                                                   const VideoWriterOptions& options = {});

}  // namespace parkade
