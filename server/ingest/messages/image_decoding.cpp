#include "server/ingest/messages/image_decoding.h"

#include <zlib.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "server/ingest/messages/jpeg_decoding.h"
#include "server/ingest/messages/packed_samples.h"

namespace parkade {
namespace {

constexpr const char* kTooFewBytes = "the image has fewer bytes than its size needs";
constexpr std::size_t kMaxFileSize = std::size_t{128} << 20;

DecodedImage Damaged(const std::string& what) { return {{}, ImageFault::kDamaged, what}; }

/// How the samples of a ROS encoding lie, and the OpenCV conversions of them (-1: none needed).
struct RawFormat {
  int type;
  int to_gray, to_bgr;
  bool has_chroma_below = false;  ///< in half as many rows, below the luma that alone is gray
};

/// Drivers spell encodings as they like.
std::string InSmallLetters(std::string encoding) {
  for (char& c : encoding) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return encoding;
}

/// Samples of 10 to 14 bits that are not packed have 16 in the message.
const RawFormat* FindFormat(std::string encoding) {
  encoding = InSmallLetters(std::move(encoding));
  static constexpr RawFormat kYuyv = {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2};
  static constexpr RawFormat kUyvy = {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY};
  static constexpr RawFormat kBgra = {CV_8UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR};
  // OpenCV names a Bayer pattern by its second row: ROS' rggb is OpenCV's BG.
  static const std::map<std::string, RawFormat> formats = {
      {"mono8", {CV_8UC1, -1, -1}},
      {"8uc1", {CV_8UC1, -1, -1}},
      {"mono16", {CV_16UC1, -1, -1}},
      {"16uc1", {CV_16UC1, -1, -1}},
      {"bgr8", {CV_8UC3, cv::COLOR_BGR2GRAY, -1}},
      {"8uc3", {CV_8UC3, cv::COLOR_BGR2GRAY, -1}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR}},
      {"bgra8", kBgra},
      {"8uc4", kBgra},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2GRAY, cv::COLOR_RGBA2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR}},
      {"bayer_rggb16", {CV_16UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr16", {CV_16UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg16", {CV_16UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg16", {CV_16UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR}},
      {"yuv422", kUyvy},
      {"uyvy", kUyvy},
      {"yuv422_yuy2", kYuyv},
      {"yuyv", kYuyv},
      {"yuy2", kYuyv},
      {"nv12", {CV_8UC1, -1, cv::COLOR_YUV2BGR_NV12, true}},
      {"nv21", {CV_8UC1, -1, cv::COLOR_YUV2BGR_NV21, true}},
  };
  auto found = formats.find(encoding);
  for (const char* bits : {"10", "12", "14"})
    if (found == formats.end() && encoding.ends_with(bits))
      found = formats.find(encoding.substr(0, encoding.size() - 2) + "16");
  return found == formats.end() ? nullptr : &found->second;
}

cv::Mat WithSwappedBytes(const cv::Mat& image) {
  cv::Mat swapped(image.size(), image.type());
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint16_t>(y);
    auto* to = swapped.ptr<std::uint16_t>(y);
    for (int x = 0; x < image.cols; ++x)
      to[x] = static_cast<std::uint16_t>(from[x] << 8 | from[x] >> 8);
  }
  return swapped;
}

/// Turns samples of 16 bits into 8: the upper eight of the bits in use.
cv::Mat WithEightBits(const cv::Mat& image, int sample_bits) {
  if (image.depth() != CV_16U) return image;
  cv::Mat narrow(image.size(), CV_MAKETYPE(CV_8U, image.channels()));
  const int shift = sample_bits - 8;
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint16_t>(y);
    auto* to = narrow.ptr(y);
    for (int x = 0; x < image.cols * image.channels(); ++x)
      to[x] = static_cast<std::uint8_t>(std::min(from[x] >> shift, 255));
  }
  return narrow;
}

bool HasImpossibleSide(const ImageMessage& message) {
  constexpr std::uint32_t kMaxSide = 1 << 16;
  return message.width > kMaxSide || message.height > kMaxSide;
}

/// A view of the pixels, with what lies below them where `num_rows` says so; nothing when the
/// message contradicts itself. Some drivers leave out the step.
std::optional<cv::Mat> ViewOf(const ImageMessage& message, int type, std::size_t num_rows) {
  if (HasImpossibleSide(message)) return std::nullopt;
  const std::size_t row_size = std::size_t{message.width} * CV_ELEM_SIZE(type);
  const std::size_t step = message.step == 0 ? row_size : message.step;
  if (message.width == 0 || message.height == 0 || step < row_size) return std::nullopt;
  if (message.data.size() < step * (num_rows - 1) + row_size) return std::nullopt;
  // cv::Mat has no const view; nothing writes through this one.
  return cv::Mat(static_cast<int>(num_rows), static_cast<int>(message.width), type,
                 const_cast<std::uint8_t*>(message.data.data()), step);
}

std::uint32_t BigEndian32(std::span<const std::uint8_t> data) {
  return std::uint32_t{data[0]} << 24 | std::uint32_t{data[1]} << 16 | std::uint32_t{data[2]} << 8 |
         data[3];
}

/// True when every chunk is whole by its checksum, up to the last. Spares libpng the damaged ones,
/// about which it talks on stderr.
bool HasWholeChunks(std::span<const std::uint8_t> data) {
  constexpr std::size_t kSignatureSize = 8, kOverhead = 12;  // length, type, checksum
  for (data = data.subspan(kSignatureSize); data.size() >= kOverhead;) {
    const std::size_t size = BigEndian32(data);
    if (size > data.size() - kOverhead) return false;
    const auto* type = data.data() + 4;
    if (crc32(0, type, static_cast<uInt>(size + 4)) != BigEndian32(data.subspan(8 + size)))
      return false;
    if (std::memcmp(type, "IEND", 4) == 0) return true;
    data = data.subspan(size + kOverhead);
  }
  return false;
}

/// The size stands in the header: a small file that claims a huge image is refused before anything
/// is unpacked.
DecodedImage DecodePng(std::span<const std::uint8_t> data, const ImageRequest& request) {
  constexpr std::uint32_t kMaxSide = 1 << 16;
  const std::uint32_t width = BigEndian32(data.subspan(16)), height = BigEndian32(data.subspan(20));
  if (width > kMaxSide || height > kMaxSide) return Damaged("PNG: impossible size");
  if (auto fault = CheckSize(static_cast<int>(width), static_cast<int>(height), request))
    return *fault;
  if (!HasWholeChunks(data)) return Damaged("PNG: damaged data");
  const cv::Mat encoded(1, static_cast<int>(data.size()), CV_8UC1,
                        const_cast<std::uint8_t*>(data.data()));
  cv::Mat image;
  try {
    image = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) return Damaged("PNG: damaged data");
  image = WithEightBits(image, request.sample_bits);
  DecodedImage decoded{image, {}, {}};
  const int channels = image.channels();
  if (channels > 1 && request.grayscale)
    cv::cvtColor(image, decoded.image, channels == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  else if (channels == 4)
    cv::cvtColor(image, decoded.image, cv::COLOR_BGRA2BGR);
  return decoded;
}

DecodedImage DecodePacked(ImageMessage message, const PackedEncoding& packed,
                          const ImageRequest& request) {
  const std::optional<std::vector<std::uint8_t>> samples = UpperEightBits(message, packed.bits);
  if (!samples) return Damaged(kTooFewBytes);
  message.encoding = packed.eight_bit;
  message.step = 0;
  message.data = *samples;
  return DecodeRaw(message, request);
}

std::filesystem::path PathOf(const RawMessage& message) {
  return std::string(message.data.begin(), message.data.end());
}

}  // namespace

bool IsPng(std::span<const std::uint8_t> data) {
  constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  return data.size() >= 33 && std::equal(kSignature.begin(), kSignature.end(), data.begin());
}

bool IsJpeg(std::span<const std::uint8_t> data) {
  return data.size() > 3 && data[0] == 0xff && data[1] == 0xd8;
}

DecodedImage DecodeCompressed(std::span<const std::uint8_t> data, const ImageRequest& request) {
  if (IsPng(data)) return DecodePng(data, request);
  if (IsJpeg(data)) return DecodeJpeg(data, request);
  return Damaged("neither JPEG nor PNG");
}

DecodedImage DecodeRaw(const ImageMessage& message, const ImageRequest& request) {
  const auto packed = FindPackedEncoding(InSmallLetters(message.encoding));
  const RawFormat* format = FindFormat(message.encoding);
  if (!packed && !format)
    return Damaged("encoding '" + message.encoding.substr(0, 40) + "' is not supported");
  if (HasImpossibleSide(message)) return Damaged("impossible size");
  if (auto fault =
          CheckSize(static_cast<int>(message.width), static_cast<int>(message.height), request))
    return *fault;
  if (packed) return DecodePacked(message, *packed, request);
  const bool needs_chroma = format->has_chroma_below && !request.grayscale;
  if (needs_chroma && (message.width % 2 != 0 || message.height % 2 != 0))
    return Damaged("its width and height are not even, as " + message.encoding + " needs");
  const std::optional<cv::Mat> view =
      ViewOf(message, format->type, message.height + (needs_chroma ? message.height / 2 : 0));
  if (!view) return Damaged(kTooFewBytes);
  const bool must_swap = view->depth() == CV_16U && message.is_bigendian;
  const cv::Mat samples =
      WithEightBits(must_swap ? WithSwappedBytes(*view) : *view, request.sample_bits);
  const int conversion = request.grayscale ? format->to_gray : format->to_bgr;
  DecodedImage decoded;
  if (conversion >= 0)
    cv::cvtColor(samples, decoded.image, conversion);
  else
    decoded.image = samples.data == message.data.data() ? samples.clone() : samples;
  return decoded;
}

DecodedImage DecodeMessageImage(const RawMessage& message, const SensorStream& stream,
                                const ImageRequest& request) {
  try {
    if (stream.encoding == MessageEncoding::kEuroc) {
      const std::filesystem::path file = PathOf(message);
      if (!IsFile(file))
        return Damaged("there is no file " + file.filename().string().substr(0, 40));
      const std::string content = ReadFile(file, kMaxFileSize);
      return DecodeCompressed(
          {reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, request);
    }
    if (stream.type == "sensor_msgs/Image")
      return DecodeRaw(DecodeImage(message.data, stream.encoding), request);
    return DecodeCompressed(DecodeCompressedImage(message.data, stream.encoding, stream.type).data,
                            request);
  } catch (const Error& error) {
    return Damaged(error.what());
  } catch (const cv::Exception& error) {
    return Damaged("OpenCV: " + error.err);
  }
}

std::optional<int> SampleBits(const RawMessage& message, const SensorStream& stream) {
  if (stream.type != "sensor_msgs/Image") return std::nullopt;
  ImageMessage image;
  try {
    image = DecodeImage(message.data, stream.encoding);
  } catch (const Error&) {
    return std::nullopt;
  }
  const RawFormat* format = FindFormat(image.encoding);
  if (!format || CV_MAT_DEPTH(format->type) != CV_16U) return std::nullopt;
  const std::optional<cv::Mat> view = ViewOf(image, format->type, image.height);
  if (!view) return std::nullopt;
  double max = 0;
  cv::minMaxLoc(image.is_bigendian ? WithSwappedBytes(*view) : *view, nullptr, &max);
  const auto width = static_cast<int>(std::bit_width(static_cast<unsigned>(max)));
  return std::clamp((width + 1) / 2 * 2, 8, 16);
}

}  // namespace parkade
