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

NetworkCopies::NetworkCopies(std::string model, NetworkRuntime runtime) {
  if (runtime == NetworkRuntime::kLayered) layered_ = LayeredNetwork::Read(model);
  if (layered_) return;
  model_ = std::move(model);
  idle_.push_back(Parse(model_));
}

cv::Mat NetworkCopies::Run(const cv::Mat& input) {
  if (layered_) return RunLayered(input);
  cv::dnn::Net net = Take();
  net.setInput(input);
  cv::Mat output = net.forward().clone();
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(net));
  return output;
}

cv::Mat NetworkCopies::RunLayered(const cv::Mat& input) {
  LayeredNetwork::Buffers buffers;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_buffers_.empty()) {
      buffers = std::move(idle_buffers_.back());
      idle_buffers_.pop_back();
    }
  }
  cv::Mat output = layered_->Run(input, buffers);
  const std::lock_guard lock(mutex_);
  idle_buffers_.push_back(std::move(buffers));
  return output;
}

cv::dnn::Net NetworkCopies::Take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      cv::dnn::Net net = idle_.back();
      idle_.pop_back();
      return net;
    }
  }
  return Parse(model_);
}

}  // namespace parkade
