#include "mapping/networks/layered_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "mapping/networks/builtin_network.h"
#include "mapping/networks/network_copies.h"
#include "tests/mapping/worlds/synthetic_drive.h"
#include "tests/mapping/worlds/tiny_onnx.h"

namespace parkade {
namespace {

cv::Mat Noise(const std::vector<int>& sizes, double high) {
  cv::Mat noise(sizes, CV_32F);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, high);
  return noise;
}

/// A lot, as a fisheye of a car sees it.
cv::Mat Rendered(const cv::Size& size) {
  const SyntheticScene lot = MakeLot();
  const Rig rig = MakeTestRig();
  const SyntheticDrive drive(lot, rig, DriveAlong(lot, {-10, 0, 0}, 0, {{4, 0}}, rig), false);
  cv::Mat image;
  cv::resize(drive.Render(0, drive.span().begin).first, image, size, 0, 0, cv::INTER_LINEAR);
  return cv::dnn::blobFromImage(image);
}

struct Comparison {
  double largest_difference = 0;
  double share_of_same_classes = 0;  // of one channel: signs
};

/// OpenCV's answer and ours.
Comparison Compare(std::string_view model, const cv::Mat& input) {
  LayeredNetwork::Buffers buffers;
  const cv::Mat ours = LayeredNetwork::Read(model).value().Run(input, buffers);
  const cv::Mat theirs = NetworkCopies(std::string(model)).Run(input);
  EXPECT_EQ(ours.size, theirs.size);
  const int channels = ours.size[1], pixels = ours.size[2] * ours.size[3];
  const auto class_at = [&](const cv::Mat& scores, int pixel) {
    const auto at = [&](int channel) { return scores.ptr<float>(0, channel)[pixel]; };
    if (channels == 1) return static_cast<int>(at(0) > 0);
    int best = 0;
    for (int channel = 1; channel < channels; ++channel)
      if (at(channel) > at(best)) best = channel;
    return best;
  };
  int same = 0;
  for (int pixel = 0; pixel < pixels; ++pixel)
    same += class_at(ours, pixel) == class_at(theirs, pixel);
  return {cv::norm(ours, theirs, cv::NORM_INF), static_cast<double>(same) / pixels};
}

void ExpectSame(std::string_view model, const std::vector<cv::Mat>& inputs) {
  for (const cv::Mat& input : inputs) {
    const Comparison comparison = Compare(model, input);
    EXPECT_LT(comparison.largest_difference, 1e-3) << input.size;
    EXPECT_GT(comparison.share_of_same_classes, 0.9995) << input.size;
  }
}

TEST(LayeredNetwork, OfTheLevelNetworkGivesWhatOpenCvGives) {
  ExpectSame(BuiltinLevelNetwork(), {Noise({1, 3, 288, 832}, 255), Rendered({832, 288})});
}

TEST(LayeredNetwork, OfTheFreespaceNetworkGivesWhatOpenCvGivesAtAnySize) {
  ExpectSame(BuiltinFreespaceNetwork(),
             {Noise({1, 3, 384, 640}, 255), Rendered({640, 384}), Noise({1, 3, 32, 64}, 255)});
}

TEST(LayeredNetwork, OfTheOutlineNetworkGivesWhatOpenCvGivesAtAnySize) {
  ExpectSame(BuiltinOutlineNetwork(), {Noise({1, 15, 96, 160}, 1), Noise({1, 15, 100, 68}, 1)});
}

TEST(LayeredNetwork, BuffersOfALargerImageDoNotShowInASmallerOne) {
  const LayeredNetwork network = LayeredNetwork::Read(BuiltinFreespaceNetwork()).value();
  const cv::Mat small = Noise({1, 3, 32, 64}, 255);
  LayeredNetwork::Buffers fresh, used;

  const cv::Mat expected = network.Run(small, fresh);
  network.Run(Noise({1, 3, 96, 128}, 255), used);

  EXPECT_EQ(cv::norm(network.Run(small, used), expected, cv::NORM_INF), 0);
}

TEST(LayeredNetwork, RefusesImagesOfOtherChannelsOrSizes) {
  const LayeredNetwork network = LayeredNetwork::Read(BuiltinFreespaceNetwork()).value();
  LayeredNetwork::Buffers buffers;

  EXPECT_THROW(network.Run(Noise({1, 1, 32, 64}, 255), buffers), Error);
  EXPECT_THROW(network.Run(Noise({1, 3, 40, 72}, 255), buffers), Error)
      << "images that were halved and doubled do not fit";
}

TEST(LayeredNetwork, WhatItDoesNotKnowIsLeftToOpenCv) {
  const std::string known = TinyOnnx({1, 0, 0}, {0}, 32, 16);
  std::string unknown = known;
  unknown.replace(unknown.find("Conv"), 4, "Conw");

  EXPECT_TRUE(LayeredNetwork::Read(known));
  EXPECT_FALSE(LayeredNetwork::Read(unknown));
  EXPECT_FALSE(LayeredNetwork::Read(known.substr(0, known.size() / 2)));
  EXPECT_FALSE(LayeredNetwork::Read("hello"));
  EXPECT_FALSE(LayeredNetwork::Read(""));
}

TEST(NetworkCopies, ParkadesOwnAreLayeredAndTheirBuffersUsedAgain) {
  for (const std::string_view model :
       {BuiltinFreespaceNetwork(), BuiltinLevelNetwork(), BuiltinOutlineNetwork()})
    EXPECT_TRUE(NetworkCopies(std::string(model), NetworkRuntime::kLayered).is_layered());
  EXPECT_FALSE(NetworkCopies(TinyOnnx({1, 0, 0}, {0}, 32, 16)).is_layered());
}

}  // namespace
}  // namespace parkade
