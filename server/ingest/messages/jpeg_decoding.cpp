#include "server/ingest/messages/jpeg_decoding.h"

#include <csetjmp>
#include <cstdio>
// jpeglib.h needs FILE and size_t from cstdio before it.
#include <jpeglib.h>
// jerror.h needs jpeglib.h before it.
#include <jerror.h>

#include "server/ingest/messages/jpeg_check.h"

namespace parkade {
namespace {

/// libjpeg reports through these: errors jump back, warnings are counted.
struct JpegErrors {
  jpeg_error_mgr base;  // the first member, so that libjpeg's pointer is ours, too
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX];
  bool has_stray_bytes;
};

JpegErrors* ErrorsOf(j_common_ptr codec) { return reinterpret_cast<JpegErrors*>(codec->err); }

[[noreturn]] void OnError(j_common_ptr codec) {
  codec->err->format_message(codec, ErrorsOf(codec)->message);
  std::longjmp(ErrorsOf(codec)->jump, 1);
}

void OnMessage(j_common_ptr codec, int level) {
  if (level >= 0) return;
  if (codec->err->msg_code == JWRN_EXTRANEOUS_DATA) {
    ErrorsOf(codec)->has_stray_bytes = true;
    return;
  }
  if (codec->err->num_warnings++ == 0) codec->err->format_message(codec, ErrorsOf(codec)->message);
}

void OnOutput(j_common_ptr) {}

/// The codec's state. Each method that calls libjpeg sets its own jump target and holds no object
/// with a destructor.
class JpegReader {
 public:
  explicit JpegReader(std::span<const std::uint8_t> data) : data_(data) {
    codec_.err = jpeg_std_error(&errors_.base);
    errors_.base.error_exit = OnError;
    errors_.base.emit_message = OnMessage;
    errors_.base.output_message = OnOutput;
    errors_.message[0] = '\0';
    jpeg_create_decompress(&codec_);
  }
  ~JpegReader() { jpeg_destroy_decompress(&codec_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  bool ReadHeader() {
    if (setjmp(errors_.jump)) return false;
    jpeg_mem_src(&codec_, data_.data(), data_.size());
    jpeg_read_header(&codec_, TRUE);
    return true;
  }

  int width() const { return static_cast<int>(codec_.image_width); }
  int height() const { return static_cast<int>(codec_.image_height); }
  bool is_colored() const { return codec_.num_components == 3; }
  bool has_supported_colors() const {
    return codec_.num_components == 1 || codec_.num_components == 3;
  }
  long num_warnings() const { return errors_.base.num_warnings; }
  /// Whether bytes before a marker belong to nothing.
  bool has_stray_bytes() const { return errors_.has_stray_bytes; }
  const char* message() const { return errors_.message; }

  /// `image` has the size of the header and one or three channels.
  bool ReadPixels(cv::Mat& image) {
    if (setjmp(errors_.jump)) return false;
    codec_.out_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
    jpeg_start_decompress(&codec_);
    while (codec_.output_scanline < codec_.output_height) {
      JSAMPROW row = image.ptr(static_cast<int>(codec_.output_scanline));
      jpeg_read_scanlines(&codec_, &row, 1);
    }
    jpeg_finish_decompress(&codec_);
    return true;
  }

 private:
  std::span<const std::uint8_t> data_;
  jpeg_decompress_struct codec_{};
  JpegErrors errors_{};
};

}  // namespace

DecodedImage DecodeJpeg(std::span<const std::uint8_t> data, const ImageRequest& request) {
  const auto damaged = [](const std::string& what) {
    return DecodedImage{{}, ImageFault::kDamaged, "JPEG: " + what};
  };
  JpegReader reader(data);
  if (!reader.ReadHeader()) return damaged(reader.message());
  if (auto fault = CheckSize(reader.width(), reader.height(), request)) return *fault;
  if (!reader.has_supported_colors())
    return damaged("four colors (CMYK), as printers have them: record it in three or in gray");
  DecodedImage decoded;
  decoded.image.create(reader.height(), reader.width(),
                       reader.is_colored() && !request.grayscale ? CV_8UC3 : CV_8UC1);
  if (!reader.ReadPixels(decoded.image) || reader.num_warnings() > 0)
    return damaged(reader.message());
  if (request.is_intact) return decoded;
  const JpegFinding finding = FindJpegDamage(data);
  if (finding.damage) return damaged(*finding.damage);
  if (reader.has_stray_bytes() && !finding.is_judged) return damaged("stray bytes before a marker");
  return decoded;
}

}  // namespace parkade
