#include "server/ingest/inspection/image_history.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr int kWidth = 320, kHeight = 200;

Timestamp At(double seconds) { return TimestampFromSeconds(1000 + seconds); }

/// A camera that looks at a long wall with things on it, `moved` pixels further on; every image
/// with other noise.
class WallCamera {
 public:
  explicit WallCamera(int seed)
      : random_(static_cast<std::uint64_t>(seed)), wall_(kHeight, 4000, CV_8UC1) {
    cv::Mat coarse(kHeight / 8, wall_.cols / 8, CV_8UC1);
    random_.fill(coarse, cv::RNG::UNIFORM, 40, 220);
    cv::resize(coarse, wall_, wall_.size(), 0, 0, cv::INTER_CUBIC);
  }

  cv::Mat Take(int moved, double noise = 3) {
    cv::Mat image = wall_(cv::Rect(moved, 0, kWidth, kHeight)).clone();
    return WithNoise(image, noise);
  }

  cv::Mat WithNoise(const cv::Mat& image, double noise) {
    cv::Mat deviates(image.size(), CV_16SC1), sum;
    random_.fill(deviates, cv::RNG::NORMAL, 0, noise);
    cv::add(image, deviates, sum, cv::noArray(), CV_8U);
    return sum;
  }

 private:
  cv::RNG random_;
  cv::Mat wall_;
};

void Include(ImageHistory& history, double seconds, const cv::Mat& image) {
  const bool is_sampled = history.WantsSample(At(seconds));
  history.Include(At(seconds), GlanceAt(image), is_sampled ? SampleOf(image) : std::nullopt);
}

/// What comes over the lens: changes the image of camera `camera` at a time [s].
using Veil = std::function<void(std::size_t camera, double seconds, cv::Mat& image)>;

struct Drive {
  int num_cameras = 4;
  double speed_px = 40;  ///< [px/s] at which the wall passes
  double noise = 3;      ///< [gray levels]
  double seconds = 20;
};

/// Covers found on a drive of images at 5 Hz.
std::vector<std::vector<CameraFault>> CoversOf(const Drive& drive, const Veil& veil) {
  std::vector<ImageHistory> histories(static_cast<std::size_t>(drive.num_cameras));
  for (std::size_t camera = 0; camera < histories.size(); ++camera) {
    WallCamera wall(static_cast<int>(camera) + 1);
    for (double seconds = 0.03 * static_cast<double>(camera); seconds < drive.seconds;
         seconds += 0.2) {
      cv::Mat image = wall.Take(static_cast<int>(drive.speed_px * seconds), 0);
      veil(camera, seconds, image);
      Include(histories[camera], seconds, wall.WithNoise(image, drive.noise));
    }
  }
  std::vector<const ImageHistory*> cameras;
  for (const ImageHistory& history : histories) cameras.push_back(&history);
  std::vector<std::vector<CameraFault>> covers = DetectOcclusion(cameras);
  EXPECT_EQ(covers.size(), static_cast<std::size_t>(drive.num_cameras));
  return covers;
}

void MudOnTheLeft(cv::Mat& image) { image(cv::Rect(0, 0, kWidth / 2, kHeight)) = 70; }

TEST(ImageHistory, AnOrdinaryDriveHasNoFaults) {
  ImageHistory history;
  WallCamera wall(1);
  for (int i = 0; i < 200; ++i) Include(history, 0.1 * i, wall.Take(4 * i));

  EXPECT_TRUE(history.Faults().empty());
  for (const auto& covers : CoversOf({}, [](std::size_t, double, cv::Mat&) {}))
    EXPECT_TRUE(covers.empty());
}

TEST(ImageHistory, DarkImagesAreToldWithTheirTime) {
  ImageHistory history;
  WallCamera wall(1);
  for (int i = 0; i < 100; ++i) {
    const bool is_dark = (30 <= i && i < 45) || i == 70;  // a single one is no stretch
    Include(history, 0.1 * i,
            is_dark ? wall.WithNoise(cv::Mat::zeros(kHeight, kWidth, CV_8UC1), 12) : wall.Take(i));
  }

  const std::vector<CameraFault> faults = history.Faults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, CameraFault::Kind::kDark);
  EXPECT_EQ(faults[0].begin, At(3.0));
  EXPECT_EQ(faults[0].end, At(4.4));
}

TEST(ImageHistory, AImageWithALampInItIsNotDark) {
  ImageHistory history;
  cv::Mat night = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
  cv::circle(night, {100, 80}, 20, 200, cv::FILLED);
  WallCamera wall(1);
  for (int i = 0; i < 20; ++i) Include(history, 0.1 * i, wall.WithNoise(night, 5));

  EXPECT_TRUE(history.Faults().empty());
}

TEST(ImageHistory, PicturesThatAreTheSameToTheBitAreToldAndThoseOfAStandingCarAreNot) {
  ImageHistory frozen, standing;
  WallCamera wall(1);
  const cv::Mat stuck = wall.Take(0);
  for (int i = 0; i < 100; ++i) {
    Include(frozen, 0.1 * i, 20 <= i && i < 60 ? stuck : wall.Take(4 * i));
    Include(standing, 0.1 * i, wall.Take(0));
  }

  EXPECT_TRUE(standing.Faults().empty());
  const std::vector<CameraFault> faults = frozen.Faults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, CameraFault::Kind::kUnchanged);
  EXPECT_EQ(faults[0].begin, At(2));
  EXPECT_EQ(faults[0].end, At(5.9));
}

TEST(ImageHistory, AStretchThatLastsToTheEndIsTold) {
  ImageHistory history;
  for (int i = 0; i < 30; ++i) Include(history, 0.1 * i, cv::Mat::zeros(kHeight, kWidth, CV_8UC1));

  ASSERT_EQ(history.Faults().size(), 1u);
  EXPECT_EQ(history.Faults()[0].kind, CameraFault::Kind::kDark);
  EXPECT_EQ(history.Faults()[0].end, At(2.9));
}

TEST(ImageHistory, MudThatComesAndGoesIsToldByDayAndInTheNoiseOfDimLight) {
  for (const double noise : {2.0, 12.0}) {
    const auto covers =
        CoversOf({.noise = noise}, [](std::size_t camera, double seconds, cv::Mat& image) {
          if (camera == 2 && 6 <= seconds && seconds < 14) MudOnTheLeft(image);
        });

    for (const std::size_t camera : {0u, 1u, 3u}) EXPECT_TRUE(covers[camera].empty()) << noise;
    ASSERT_EQ(covers[2].size(), 1u) << noise;
    EXPECT_NEAR(covers[2][0].begin - At(6), 0.5, 0.6);
    EXPECT_NEAR(At(14) - covers[2][0].end, 0.5, 0.6);
    EXPECT_NEAR(covers[2][0].share, 7.0 / 16, 0.06);  // blocks at its edge see the edge
  }
}

TEST(ImageHistory, MudFromTheFirstImageToTheLastShowsBesideTheOtherCameras) {
  const auto covers = CoversOf({}, [](std::size_t camera, double, cv::Mat& image) {
    if (camera == 0) MudOnTheLeft(image);
  });

  ASSERT_EQ(covers[0].size(), 1u);
  EXPECT_NEAR(covers[0][0].Seconds(), 19, 1);
}

TEST(ImageHistory, ThinMudOverMostOfADriveIsToldWhole) {
  const auto covers =
      CoversOf({.seconds = 60}, [](std::size_t camera, double seconds, cv::Mat& image) {
        if (camera != 3 || seconds < 8 || 52 <= seconds) return;
        cv::Mat behind = image(cv::Rect(0, 0, kWidth, kHeight / 2));
        behind.convertTo(behind, CV_8U, 0.15, 80 + seconds);  // as the exposure rises
      });

  for (const std::size_t camera : {0u, 1u, 2u}) EXPECT_TRUE(covers[camera].empty());
  ASSERT_EQ(covers[3].size(), 1u);
  EXPECT_NEAR(covers[3][0].begin - At(8), 0.5, 0.6);
  EXPECT_NEAR(At(52) - covers[3][0].end, 0.5, 0.6);
  EXPECT_NEAR(covers[3][0].share, 0.5, 0.1);
}

TEST(ImageHistory, ASingleCameraTellsACoverThatComes) {
  const auto covers = CoversOf({.num_cameras = 1}, [](std::size_t, double seconds, cv::Mat& image) {
    if (seconds > 10) MudOnTheLeft(image);
  });

  ASSERT_EQ(covers[0].size(), 1u);
  EXPECT_NEAR(covers[0][0].begin - At(10), 0.5, 0.6);
}

TEST(ImageHistory, TheSkyOfAllCamerasIsNoCover) {
  const auto covers = CoversOf({}, [](std::size_t, double, cv::Mat& image) {
    image(cv::Rect(0, 0, kWidth, 2 * kHeight / 5)) = 240;
  });

  for (const auto& of_camera : covers) EXPECT_TRUE(of_camera.empty());
}

TEST(ImageHistory, ABareWallThatPassesIsNoCover) {
  const auto covers = CoversOf({}, [](std::size_t camera, double seconds, cv::Mat& image) {
    const int left = static_cast<int>(kWidth - 60 * (seconds - 5));
    const cv::Rect bare = cv::Rect(left, 0, 160, kHeight) & cv::Rect(0, 0, kWidth, kHeight);
    if (camera == 1 && !bare.empty()) image(bare) = 130;
  });

  for (const auto& of_camera : covers) EXPECT_TRUE(of_camera.empty());
}

TEST(ImageHistory, StandingBeforeABareWallIsNoCover) {
  const auto covers =
      CoversOf({.speed_px = 0}, [](std::size_t camera, double seconds, cv::Mat& image) {
        if (camera == 3 && seconds > 5) MudOnTheLeft(image);
      });

  for (const auto& of_camera : covers) EXPECT_TRUE(of_camera.empty());
}

TEST(ImageHistory, OutsideOfTheLensNothingIsCovered) {
  const auto covers = CoversOf({}, [](std::size_t camera, double, cv::Mat& image) {
    cv::Mat lens = cv::Mat::zeros(image.size(), CV_8UC1);
    cv::circle(lens, {kWidth / 2, kHeight / 2}, 95, 255, cv::FILLED);
    if (camera == 0) image.setTo(0, lens == 0);
  });

  for (const auto& of_camera : covers) EXPECT_TRUE(of_camera.empty());
}

TEST(ImageHistory, MemoryStaysBoundedInLogsOfDays) {
  ImageHistory history;
  const cv::Mat image = WallCamera(1).Take(0);
  const std::optional<ImageSample> sample = SampleOf(image);
  std::size_t num_sampled = 0;
  for (int i = 0; i < 200'000; ++i) {
    const bool is_sampled = history.WantsSample(At(i));
    num_sampled += is_sampled;
    history.Include(At(i), {.brightest = 200, .content = static_cast<std::uint64_t>(i)},
                    is_sampled ? sample : std::nullopt);
  }

  EXPECT_LT(history.entries().size(), ImageHistory::kMaxSamples);
  EXPECT_GT(history.entries().size(), ImageHistory::kMaxSamples / 3);
  EXPECT_LT(num_sampled, 20'000u);
  EXPECT_EQ(history.entries().front().time, At(0));
}

TEST(ImageSample, SmallImagesHaveTooLittleDetailToMiss) {
  EXPECT_FALSE(SampleOf(cv::Mat::zeros(90, 160, CV_8UC1)));
  EXPECT_TRUE(SampleOf(cv::Mat::zeros(100, 160, CV_8UC1)));
}

TEST(ImageSample, OnePixelMakesAnotherImage) {
  cv::Mat image = WallCamera(1).Take(0)(cv::Rect(0, 0, 317, 199));
  const ImageGlance before = GlanceAt(image);
  for (const cv::Point place : {cv::Point(0, 0), cv::Point(316, 198), cv::Point(311, 77)}) {
    image.at<std::uint8_t>(place) ^= 1;
    EXPECT_NE(GlanceAt(image).content, before.content) << place;
    image.at<std::uint8_t>(place) ^= 1;
  }
  EXPECT_EQ(GlanceAt(image.clone()).content, before.content);
}

}  // namespace
}  // namespace parkade
