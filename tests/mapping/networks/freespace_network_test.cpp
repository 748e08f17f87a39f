#include "mapping/networks/freespace_network.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/parallel.h"
#include "tests/mapping/worlds/tiny_onnx.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class FreespaceNetworkFiles : public testing::Test {
 protected:
  FreespaceNetworkFiles()
      : folder_(fs::temp_directory_path() /
                ("freespace_network_test." + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~FreespaceNetworkFiles() override { fs::remove_all(folder_); }

  fs::path Write(const std::string& content) const {
    WriteFileAtomically(folder_ / "model.onnx", content);
    return folder_ / "model.onnx";
  }

  /// What the constructor says of a file with this content.
  std::string Complaint(const std::string& content) const {
    try {
      FreespaceNetwork network(Write(content));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

/// Blue rises by 1 per column, green by 2 per row.
cv::Mat Gradient(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<cv::Vec3b>(y, x) = {static_cast<uchar>(x), static_cast<uchar>(2 * y), 200};
  return image;
}

TEST_F(FreespaceNetworkFiles, TheNetworkSeesBlueGreenRedFrom0To255) {
  const FreespaceNetwork network(Write(TinyOnnx({1, 10, 100}, {-5}, 32, 16)));

  const FreespaceBelief belief = network.Run(Gradient(32, 16));

  EXPECT_EQ(network.InputSizeFor({64, 64}), cv::Size(32, 16));
  EXPECT_FLOAT_EQ(belief.At({7, 3}), 7 + 10 * 6 + 100 * 200 - 5);
}

TEST_F(FreespaceNetworkFiles, BeliefIsBilinearInPixelsOfTheImageWhateverTheNetworksSize) {
  const FreespaceNetwork network(Write(TinyOnnx({1, 0, 0}, {0}, 32, 16)));

  const FreespaceBelief belief = network.Run(Gradient(128, 64));

  EXPECT_EQ(belief.image_size, cv::Size(128, 64));
  for (const float column : {10.0F, 33.3F, 100.9F})
    EXPECT_NEAR(belief.At({column, 20}), column, 0.51) << column;
  EXPECT_NEAR(belief.At({-50, -50}), belief.At({0, 0}), 1e-6) << "off the image its border counts";
}

TEST_F(FreespaceNetworkFiles, OfTwoChannelsTheSecondIsDrivable) {
  const FreespaceNetwork network(Write(TinyOnnx({0, 1, 0, 1, 0, 0}, {0, 0}, 64, 32)));

  const FreespaceBelief belief = network.Run(Gradient(64, 32));

  EXPECT_NEAR(belief.At({50, 4}), 50 - 8, 1e-4);
  EXPECT_EQ(belief.ClassAt({50, 4}), SurfaceClass::kUnknown);
  EXPECT_EQ(belief.Mask().at<uchar>(4, 50), 255);
  EXPECT_EQ(belief.Mask().at<uchar>(30, 20), 0);
}

TEST_F(FreespaceNetworkFiles, OfNineChannelsTheFirstTwoAreDrivable) {
  // Of a pixel (column, row): 0.1 column for markings, 1 for drivable, 0.2 row for kerbs.
  std::vector<float> weights(3 * kNumSurfaceClasses, 0), biases(kNumSurfaceClasses, -20);
  weights[3 * static_cast<size_t>(SurfaceClass::kMarking)] = 0.1F;
  weights[3 * static_cast<size_t>(SurfaceClass::kKerb) + 1] = 0.1F;
  biases[0] = 1, biases[1] = 0, biases[static_cast<size_t>(SurfaceClass::kKerb)] = 0;
  const FreespaceNetwork network(Write(TinyOnnx(weights, biases, 64, 32)));

  const FreespaceBelief belief = network.Run(Gradient(64, 32));

  EXPECT_EQ(belief.ClassAt({50, 3}), SurfaceClass::kMarking);
  EXPECT_EQ(belief.ClassAt({3, 2}), SurfaceClass::kDrivable);
  EXPECT_EQ(belief.ClassAt({3, 30}), SurfaceClass::kKerb);
  const float green = 2 * 20;  // of Gradient, in row 20
  // Markings and kerbs weigh twice and three times in one of two losses of the training.
  EXPECT_NEAR(belief.At({40, 20}),
              std::log((std::exp(4) / std::sqrt(2) + std::exp(1)) * std::sqrt(3)) - 0.1F * green,
              1e-3);
}

TEST_F(FreespaceNetworkFiles, ANetworkOfOpenSizeIsRunAt320x208) {
  const FreespaceNetwork network(Write(TinyOnnx({1, 0, 0}, {0}, 0, 0)));

  EXPECT_EQ(network.InputSizeFor({64, 48}), cv::Size(320, 208));
  EXPECT_NEAR(network.Run(Gradient(64, 48)).At({30, 20}), 30, 1);
}

TEST(FreespaceNetwork, OursTakesImagesInTheirOwnProportions) {
  const FreespaceNetwork network;
  EXPECT_EQ(network.InputSizeFor({640, 400}), cv::Size(640, 384));
  EXPECT_EQ(network.InputSizeFor({1280, 800}), cv::Size(640, 384));
  EXPECT_EQ(network.InputSizeFor({1280, 720}), cv::Size(640, 384));
  EXPECT_EQ(network.InputSizeFor({1280, 960}), cv::Size(512, 384));
  EXPECT_EQ(network.InputSizeFor({1000, 1000}), cv::Size(384, 384));
  EXPECT_EQ(network.InputSizeFor({480, 640}), cv::Size(288, 384));
  EXPECT_EQ(network.InputSizeFor({6400, 10}), cv::Size(640, 32));
  for (const cv::Size& size :
       {cv::Size(48, 36), cv::Size(640, 400), cv::Size(36, 48), cv::Size(640, 4)}) {
    const FreespaceBelief belief = network.Run(cv::Mat(size, CV_8UC3, cv::Scalar::all(90)));
    EXPECT_EQ(belief.log_odds.size() * 2, network.InputSizeFor(size));
    EXPECT_EQ(belief.Mask().size(), size);
  }
}

TEST_F(FreespaceNetworkFiles, SmallIslandsOfDrivableGroundAreDoubted) {
  const FreespaceNetwork network(Write(TinyOnnx({1, 0, 0}, {-100}, 128, 64)));
  cv::Mat image(64, 128, CV_8UC3, cv::Scalar::all(50));
  const cv::Rect ground(0, 32, 128, 32), island(20, 8, 8, 8), speck(100, 8, 6, 6);
  for (const cv::Rect& part : {ground, island, speck}) image(part).setTo(cv::Scalar::all(150));

  const FreespaceBelief belief = network.Run(image);

  EXPECT_FLOAT_EQ(belief.At({60, 50}), 50);
  EXPECT_FLOAT_EQ(belief.At({24, 12}), 50) << "0.8 % of the image";
  EXPECT_FLOAT_EQ(belief.At({103, 11}), 0) << "0.4 % of the image";
  EXPECT_FLOAT_EQ(belief.At({60, 12}), -50);
  EXPECT_EQ(belief.Mask().at<uchar>(11, 103), 0);
}

TEST_F(FreespaceNetworkFiles, GrayImagesAreThreeTimesTheSame) {
  const FreespaceNetwork network(Write(TinyOnnx({1, 1, 1}, {0}, 32, 16)));

  EXPECT_NEAR(network.Run(cv::Mat(16, 32, CV_8UC1, cv::Scalar(50))).At({5, 5}), 150, 1e-3);
}

TEST_F(FreespaceNetworkFiles, FilesThatAreNoNetworkAreNamedInOneSentence) {
  const std::string good = TinyOnnx({1, 0, 0}, {0}, 32, 16);
  for (const std::string& content :
       {std::string(), std::string("hello"), std::string(5000, '\7'),
        good.substr(0, good.size() / 2), std::string("\x89PNG\r\n\x1a\n")}) {
    const std::string complaint = Complaint(content);
    EXPECT_NE(complaint.find("model.onnx"), std::string::npos) << complaint;
    EXPECT_EQ(complaint.find('\n'), std::string::npos) << complaint;
  }
}

TEST_F(FreespaceNetworkFiles, ANetworkOfFiveClassesIsToldWhatIsWanted) {
  const std::string complaint =
      Complaint(TinyOnnx(std::vector<float>(15, 1.0F), std::vector<float>(5), 32, 16));

  EXPECT_NE(complaint.find("1 x 2 x h x w"), std::string::npos) << complaint;
}

TEST_F(FreespaceNetworkFiles, AFileThatIsNotThereIsNotFound) {
  try {
    FreespaceNetwork network(folder_ / "missing.onnx");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kNotFound);
    EXPECT_NE(std::string(error.what()).find("missing.onnx"), std::string::npos);
  }
}

TEST(BuiltinFreespaceNetwork, GivesTheSameAnswerOnManyThreads) {
  const FreespaceNetwork network;
  const cv::Mat image = Gradient(160, 100);
  const cv::Mat expected = network.Run(image).log_odds;

  const std::vector<double> differences = ParallelMap(
      8, [&](size_t) { return cv::norm(network.Run(image).log_odds, expected, cv::NORM_INF); });

  for (const double difference : differences) EXPECT_EQ(difference, 0);
}

TEST(BuiltinFreespaceNetwork, RefusesImagesOf16Bits) {
  EXPECT_THROW(FreespaceNetwork().Run(cv::Mat(10, 10, CV_16UC1, cv::Scalar(0))), Error);
}

TEST(BuiltinFreespaceNetwork, FindsTheRoadOfCamVid) {
  const char* shared = std::getenv("PARKADE_SHARED_DATA");
  const fs::path folder = fs::path(shared != nullptr ? shared : "../shared/data") / "camvid/val";
  if (!fs::exists(folder)) GTEST_SKIP() << "no CamVid in " << folder;
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(folder / "images"))
    images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  const FreespaceNetwork network;

  int both = 0, either = 0;
  for (size_t i = 0; i < images.size(); i += 10) {
    const cv::Mat classes =
        cv::imread((folder / "labels" / images[i].stem()).string() + ".png", cv::IMREAD_GRAYSCALE);
    const cv::Mat road = classes == 3, known = classes != 11;
    const cv::Mat found = network.Run(cv::imread(images[i].string())).Mask() & known;
    both += cv::countNonZero(found & road);
    either += cv::countNonZero(found | road);
  }

  ASSERT_GT(either, 0);
  EXPECT_GT(static_cast<double>(both) / either, 0.90) << "the floor of IoU";
}

}  // namespace
}  // namespace parkade
