#include "mapping/networks/freespace_network.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "mapping/networks/builtin_network.h"
#include "mapping/networks/network_copies.h"
#include "mapping/networks/onnx_input_size.h"
#include "mapping/networks/tell_classes.h"

namespace parkade {
namespace {

constexpr size_t kMaxBytes = size_t{512} << 20;
constexpr double kMinIsland = 0.005;  // of the image
const cv::Size kOpenSize(320, 208);   // of networks that leave their input's size open
constexpr int kOwnMultiple =
    32;  // pixels: what the sides of our own network's input are multiples of

constexpr int kNumClasses = static_cast<int>(kNumSurfaceClasses);

/// By how much classes are told too often: in training pixels of markings and vehicles weigh twice,
/// of kerbs three times and of persons six times (RARE of training/train.py), in one of two losses.
const std::array<float, kNumSurfaceClasses> kOverrated = {
    1, std::sqrt(2.0F), 1, 1, std::sqrt(3.0F), std::sqrt(2.0F), std::sqrt(6.0F), 1, 1};

/// What an output of 1 x 9 x h x w says.
void ReadClasses(const cv::Mat& scores, FreespaceBelief& belief) {
  const int rows = scores.size[2], columns = scores.size[3];
  belief.log_odds.create(rows, columns, CV_32F);
  belief.classes.create(rows, columns, CV_8U);
  for (int row = 0; row < rows; ++row) {
    ClassScores of_row;
    for (int k = 0; k < kNumClasses; ++k)
      of_row[static_cast<size_t>(k)] = scores.ptr<float>(0, k) + row * columns;
    TellClasses(of_row, kOverrated,
                {belief.classes.ptr<std::uint8_t>(row), static_cast<size_t>(columns)},
                belief.log_odds.ptr<float>(row));
  }
}

/// What an output of 1 x C x h x w says, which must have one, two or nine channels.
FreespaceBelief BeliefOf(const cv::Mat& output) {
  const int channels = output.dims == 4 ? output.size[1] : 0;
  const bool is_usable = (channels == 1 || channels == 2 || channels == kNumClasses) &&
                         output.type() == CV_32F && output.size[0] == 1 && output.size[2] > 1 &&
                         output.size[3] > 1;
  Require(is_usable, ErrorCode::kInvalidInput,
          "its output is not 1 x 1 x h x w (log-odds), 1 x 2 x h x w (scores) or 1 x 9 x h x w "
          "(scores of Parkade's classes)");
  const auto channel = [&](int index) {
    return cv::Mat(output.size[2], output.size[3], CV_32F,
                   const_cast<float*>(output.ptr<float>(0, index)));
  };
  FreespaceBelief belief;
  if (channels == kNumClasses)
    ReadClasses(output, belief);
  else
    belief.log_odds = channels == 1 ? channel(0).clone() : cv::Mat(channel(1) - channel(0));
  return belief;
}

/// The largest size within `limit` that has the proportions of `image`, its sides rounded up to
/// what our own network takes.
cv::Size OwnSizeFor(const cv::Size& image, const cv::Size& limit) {
  const double scale = std::min(limit.width / static_cast<double>(image.width),
                                limit.height / static_cast<double>(image.height));
  const auto round_up = [&](int length) {
    return kOwnMultiple *
           std::max(1, static_cast<int>(std::ceil(scale * length / kOwnMultiple - 1e-6)));
  };
  return {round_up(image.width), round_up(image.height)};
}

/// What a camera of a car calls drivable hangs together: small islands, specks on walls most often,
/// get log-odds of 0.
void DoubtIslands(cv::Mat& log_odds) {
  cv::Mat labels, stats, centroids;
  const cv::Mat is_free = log_odds > 0;
  const int num_labels = cv::connectedComponentsWithStats(is_free, labels, stats, centroids, 4);
  const double min_area = kMinIsland * static_cast<double>(log_odds.total());
  std::vector<std::uint8_t> is_island(static_cast<size_t>(num_labels));
  for (int i = 1; i < num_labels; ++i)
    is_island[static_cast<size_t>(i)] = stats.at<int>(i, cv::CC_STAT_AREA) < min_area;
  for (int row = 0; row < labels.rows; ++row)
    for (int column = 0; column < labels.cols; ++column)
      if (is_island[static_cast<size_t>(labels.at<int>(row, column))])
        log_odds.at<float>(row, column) = 0;
}

}  // namespace

float FreespaceBelief::At(const Eigen::Vector2f& pixel) const {
  const auto on_axis = [](float at, int image_length, int length) {
    const float scale = static_cast<float>(length) / static_cast<float>(image_length);
    return std::clamp((at + 0.5F) * scale - 0.5F, 0.0F, static_cast<float>(length - 1));
  };
  const float column = on_axis(pixel.x(), image_size.width, log_odds.cols);
  const float row = on_axis(pixel.y(), image_size.height, log_odds.rows);
  const int x = std::min(static_cast<int>(column), log_odds.cols - 2);
  const int y = std::min(static_cast<int>(row), log_odds.rows - 2);
  const float fx = column - static_cast<float>(x), fy = row - static_cast<float>(y);
  const float* upper = log_odds.ptr<float>(y) + x;
  const float* lower = log_odds.ptr<float>(y + 1) + x;
  return (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) +
         (lower[0] * (1 - fx) + lower[1] * fx) * fy;
}

SurfaceClass FreespaceBelief::ClassAt(const Eigen::Vector2f& pixel) const {
  if (classes.empty()) return SurfaceClass::kUnknown;
  const auto on_axis = [](float at, int image_length, int length) {
    const float scale = static_cast<float>(length) / static_cast<float>(image_length);
    return std::clamp(static_cast<int>((at + 0.5F) * scale), 0, length - 1);
  };
  return static_cast<SurfaceClass>(
      classes.at<std::uint8_t>(on_axis(pixel.y(), image_size.height, classes.rows),
                               on_axis(pixel.x(), image_size.width, classes.cols)));
}

bool FreespaceBelief::Covers(const Eigen::Vector2f& pixel) const {
  const Eigen::Array2f size(static_cast<float>(image_size.width),
                            static_cast<float>(image_size.height));
  return (pixel.array() >= -0.5F).all() && (pixel.array() <= size - 0.5F).all();
}

cv::Mat FreespaceBelief::Mask() const {
  cv::Mat full;
  cv::resize(log_odds, full, image_size, 0, 0, cv::INTER_LINEAR);
  return full > 0;
}

/// The network, and what it takes and gives.
class FreespaceNetwork::Copies {
 public:
  Copies(std::string model, bool is_own)
      : input_size_(FindOnnxInputSize(model).value_or(kOpenSize)),
        is_own_(is_own),
        networks_(std::move(model), is_own ? NetworkRuntime::kLayered : NetworkRuntime::kOpenCv) {}

  cv::Size InputSizeFor(const cv::Size& image) const {
    return is_own_ ? OwnSizeFor(image, input_size_) : input_size_;
  }

  /// `image` is of such a size.
  FreespaceBelief Run(const cv::Mat& image) {
    return BeliefOf(networks_.Run(cv::dnn::blobFromImage(image)));
  }

 private:
  cv::Size input_size_;
  bool is_own_;
  NetworkCopies networks_;
};

FreespaceNetwork::FreespaceNetwork(const std::filesystem::path& file)
    : FreespaceNetwork(
          file.empty() ? std::string(BuiltinFreespaceNetwork()) : ReadFile(file, kMaxBytes),
          file.empty(),
          file.empty() ? "the built-in free-space network" : "'" + file.string() + "'") {}

std::unique_ptr<FreespaceNetwork> FreespaceNetwork::OfLevelViews() {
  return std::unique_ptr<FreespaceNetwork>(new FreespaceNetwork(
      std::string(BuiltinLevelNetwork()), true, "the built-in network of level views"));
}

FreespaceNetwork::FreespaceNetwork(std::string model, bool is_own, const std::string& name) {
  const QuietOpenCv quiet;
  try {
    copies_ = std::make_unique<Copies>(std::move(model), is_own);
    copies_->Run(cv::Mat(copies_->InputSizeFor({640, 400}), CV_8UC3, cv::Scalar::all(128)));
  } catch (const Error& error) {
    throw Error(ErrorCode::kInvalidInput, name + " is no free-space network: " + error.what());
  } catch (const std::exception&) {
    throw Error(ErrorCode::kInvalidInput,
                name + " is no free-space network: OpenCV cannot run it as ONNX");
  }
}

FreespaceNetwork::~FreespaceNetwork() = default;

cv::Size FreespaceNetwork::InputSizeFor(const cv::Size& image) const {
  return copies_->InputSizeFor(image);
}

FreespaceBelief FreespaceNetwork::Run(const cv::Mat& image) const {
  Require(
      !image.empty() && image.depth() == CV_8U && (image.channels() == 1 || image.channels() == 3),
      ErrorCode::kInvalidInput, "the network takes gray and color images of 8 bits");
  // Averaging, as in training: blobFromImage alone would skip pixels.
  cv::Mat resized, color;
  cv::resize(image, resized, copies_->InputSizeFor(image.size()), 0, 0, cv::INTER_AREA);
  if (resized.channels() == 1)
    cv::cvtColor(resized, color, cv::COLOR_GRAY2BGR);
  else
    color = resized;
  FreespaceBelief belief = copies_->Run(color);
  belief.image_size = image.size();
  DoubtIslands(belief.log_odds);
  return belief;
}

}  // namespace parkade
