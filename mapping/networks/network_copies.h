#pragma once

#include <mutex>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/networks/layered_network.h"

namespace parkade {

/// OpenCV prints what it throws as well; the caller hears it once, from us.
class QuietOpenCv {
 public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

/// What runs a network.
enum class NetworkRuntime {
  kOpenCv,   ///< OpenCV's dnn: any network that it can read
  kLayered,  ///< LayeredNetwork where it knows all of the network, else OpenCV: Parkade's own
};

/// As many copies of one ONNX network as there are callers at a time: OpenCV's are for one thread
/// each. Of a LayeredNetwork there is one, and buffers for each caller.
class NetworkCopies {
 public:
  /// \param model  the file's bytes. Throws cv::Exception where OpenCV cannot read them.
  explicit NetworkCopies(std::string model, NetworkRuntime runtime = NetworkRuntime::kOpenCv);

  /// The output of the last layer. Thread-safe. Throws cv::Exception, or Error where LayeredNetwork
  /// does.
  cv::Mat Run(const cv::Mat& input);

  bool is_layered() const { return layered_.has_value(); }

 private:
  cv::Mat RunLayered(const cv::Mat& input);
  cv::dnn::Net Take();

  std::optional<LayeredNetwork> layered_;
  std::vector<LayeredNetwork::Buffers> idle_buffers_;
  std::string model_;  // empty where it is layered
  std::vector<cv::dnn::Net> idle_;
  std::mutex mutex_;  // of what is idle
};

}  // namespace parkade
