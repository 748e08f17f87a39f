#include "mapping/networks/network_copies.h"

#include <utility>

namespace parkade {
namespace {

cv::dnn::Net Parse(const std::string& model) {
  cv::dnn::Net net = cv::dnn::readNetFromONNX(model.data(), model.size());
  net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  return net;
}

}  // namespace

NetworkCopies::NetworkCopies(std::string model) : model_(std::move(model)), idle_{Parse(model_)} {}

cv::Mat NetworkCopies::Run(const cv::Mat& input) {
  cv::dnn::Net net = Take();
  net.setInput(input);
  cv::Mat output = net.forward().clone();
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(net));
  return output;
}

cv::dnn::Net NetworkCopies::Take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      cv::dnn::Net net = std::move(idle_.back());
      idle_.pop_back();
      return net;
    }
  }
  return Parse(model_);
}

}  // namespace parkade
