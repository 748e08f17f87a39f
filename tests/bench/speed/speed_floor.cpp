#include "tests/bench/speed/speed_floor.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/files/file.h"
#include "mapping/networks/freespace_network.h"
#include "mapping/networks/level_view.h"

namespace parkade {
namespace {

constexpr int kCorners = 180, kWindow = 17, kTopLevel = 3;
constexpr double kCornerQuality = 0.001, kCornerDistance = 12;  // [px] of OpenCV's detector
constexpr int kFreshCorners = 10;                               // [images] that corners serve
constexpr size_t kPieces = 5;                                   // of the drive
constexpr int kNetworkRuns = 10;
constexpr size_t kMaxFile = size_t{4} << 30;

using Jpeg = std::vector<uchar>;

template <typename Work>
double ProcessorSecondsOf(const Work& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::int64_t CountImages(const DriveLog& log) {
  std::int64_t count = 0;
  ReadOptions read;
  read.imu = read.wheels = read.gnss = false;
  read.wants_image = [&](int, Timestamp) {
    ++count;
    return false;
  };
  const auto stream = log.Read(read);
  while (stream->Next()) {
  }
  return count;
}

/// Images of one camera that follow each other.
using Sequence = std::vector<Jpeg>;

/// kPieces pieces of the drive, of each camera, `sample` images in all.
std::vector<Sequence> ReadSample(const DriveLog& log, int sample) {
  const size_t num_cameras = log.rig().cameras.size();
  const size_t wanted = static_cast<size_t>(sample) / num_cameras / kPieces + 2;
  std::vector<Sequence> sequences(num_cameras * kPieces);
  std::vector<size_t> asked(sequences.size(), 0);
  const auto sequence_of = [&](int camera, Timestamp time) {
    const double share = (time - log.span().begin) / log.span().Seconds();
    const auto piece = static_cast<size_t>(std::clamp(share, 0.0, 0.999) * kPieces);
    return static_cast<size_t>(camera) * kPieces + piece;
  };
  ReadOptions read;
  read.imu = read.wheels = read.gnss = read.grayscale = false;  // colored JPEGs cost more to decode
  read.wants_image = [&](int camera, Timestamp time) {
    return asked[sequence_of(camera, time)]++ < wanted;
  };
  const auto stream = log.Read(read);
  while (const auto record = stream->Next()) {
    const auto* frame = std::get_if<CameraFrame>(&*record);
    if (!frame) continue;
    Jpeg& jpeg = sequences[sequence_of(frame->camera, frame->time)].emplace_back();
    cv::imencode(".jpg", frame->image, jpeg, {cv::IMWRITE_JPEG_QUALITY, 90});
  }
  return sequences;
}

std::vector<cv::Mat> PyramidOf(const cv::Mat& image) {
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(image, pyramid, {kWindow, kWindow}, kTopLevel);
  return pyramid;
}

/// [s] for all images but the first.
double FollowThrough(const Sequence& images) {
  const cv::Size window(kWindow, kWindow);
  double seconds = 0;
  cv::Mat last_image;
  std::vector<cv::Mat> last;
  std::vector<cv::Point2f> corners;
  for (size_t i = 0; i < images.size(); ++i) {
    cv::Mat image;
    std::vector<cv::Mat> now;
    std::vector<cv::Point2f> found, back;
    std::vector<uchar> is_found;
    std::vector<float> error;
    if (i % kFreshCorners == 1)
      cv::goodFeaturesToTrack(last_image, corners, kCorners, kCornerQuality, kCornerDistance);
    const double spent = ProcessorSecondsOf([&] {
      image = cv::imdecode(images[i], cv::IMREAD_GRAYSCALE);
      now = PyramidOf(image);
      if (i == 0 || corners.empty()) return;
      cv::calcOpticalFlowPyrLK(last, now, corners, found, is_found, error, window, kTopLevel);
      cv::calcOpticalFlowPyrLK(now, last, found, back, is_found, error, window, kTopLevel);
    });
    if (i > 0) seconds += spent;
    last = std::move(now);
    last_image = image;
    if (!found.empty()) corners = std::move(found);
  }
  return seconds;
}

/// [s] of one image of the size that the network sees.
double AskNetwork() {
  const auto network = FreespaceNetwork::OfLevelViews();
  cv::Mat image(LevelView::kHeight, LevelView::kWidth, CV_8UC3);
  cv::randu(image, 0, 256);
  network->Run(image);
  return ProcessorSecondsOf([&] {
           for (int run = 0; run < kNetworkRuns; ++run) network->Run(image);
         }) /
         kNetworkRuns;
}

double CopyAll(const std::filesystem::path& map) {
  double seconds = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(map)) {
    if (!file.is_regular_file()) continue;
    const std::string bytes = ReadFile(file.path(), kMaxFile);
    std::string copy(bytes.size(), '\0');
    seconds += ProcessorSecondsOf([&] { std::memcpy(copy.data(), bytes.data(), bytes.size()); });
  }
  return seconds;
}

}  // namespace

SpeedFloor MeasureSpeedFloor(const DriveLog& log, const std::filesystem::path& map, int sample) {
  SpeedFloor floor;
  floor.images = CountImages(log);
  double seconds = 0;
  size_t count = 0;
  for (const Sequence& images : ReadSample(log, sample)) {
    seconds += FollowThrough(images);
    count += std::max<size_t>(images.size(), 1) - 1;
  }
  Require(count > 0, ErrorCode::kInvalidInput, "the drive has too few images to measure with");
  floor.follow = seconds / static_cast<double>(count);
  floor.network = AskNetwork();
  floor.copy = CopyAll(map);
  return floor;
}

}  // namespace parkade
