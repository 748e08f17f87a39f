#pragma once

#include <mutex>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

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

/// As many copies of one ONNX network as there are callers at a time: OpenCV's are for one thread
/// each.
class NetworkCopies {
 public:
  /// \param model  the file's bytes. Throws cv::Exception where OpenCV cannot read them.
  explicit NetworkCopies(std::string model);

  /// The output of the last layer. Thread-safe. Throws cv::Exception.
  cv::Mat Run(const cv::Mat& input);

 private:
  cv::dnn::Net Take();

  std::string model_;
  std::vector<cv::dnn::Net> idle_;
  std::mutex mutex_;
};

}  // namespace parkade
