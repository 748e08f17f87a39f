#include "server/ingest/checks/camera_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

namespace parkade {
namespace {

constexpr double kSpeed = 3, kRate = 5;  // [m/s], [Hz]

double YawRateAt(double time) { return 0.4 * std::sin(time); }

/// Three cameras that look left, right and ahead, 1 m above the ground, in a car that drives
/// curves.
class TurningCar {
 public:
  TurningCar() {
    rig_.vehicle.emplace();
    // Right, down and ahead of each camera, which looks a little down.
    const Eigen::Quaterniond look_ahead =
        Eigen::Quaterniond((Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished()) *
        ExpSo3({-0.3, 0, 0});
    const auto add = [&](const char* name, double heading, const Eigen::Vector3d& place) {
      RigCamera camera;
      camera.name = name;
      camera.model = CameraModel(PinholeProjection{160, 160, 159.5, 99.5}, 320, 200);
      camera.body_from_camera = {ExpSo3({0, 0, heading}) * look_ahead, place};
      rig_.cameras.push_back(camera);
    };
    add("cam0", M_PI / 2, {1, 1, 1});
    add("cam1", -M_PI / 2, {1, -1, 1});
    add("cam2", 0, {3, 0, 1});
    std::mt19937 random(5);
    std::uniform_real_distribution<double> along(-10, 70), beside(3, 12), up(-0.5, 5);
    for (int i = 0; i < 3000; ++i)
      points_.emplace_back(along(random), (i % 3 - 1) * beside(random), up(random));
  }

  const Rig& rig() const { return rig_; }

  cv::Mat Look(size_t camera, const Rigid3& world_from_body) const {
    cv::Mat image(200, 320, CV_8UC1, cv::Scalar(60));
    const Rigid3 camera_from_world =
        (world_from_body * rig_.cameras[camera].body_from_camera).Inverse();
    for (size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d point = camera_from_world * points_[i];
      if (point.z() < 1) continue;
      const Eigen::Vector2d pixel(159.5 + 160 * point.x() / point.z(),
                                  99.5 + 160 * point.y() / point.z());
      constexpr int kShift = 4;
      const double scale = 1 << kShift;
      cv::rectangle(image,
                    cv::Point(static_cast<int>((pixel.x() - 2) * scale),
                              static_cast<int>((pixel.y() - 2) * scale)),
                    cv::Point(static_cast<int>((pixel.x() + 2) * scale),
                              static_cast<int>((pixel.y() + 2) * scale)),
                    cv::Scalar(i % 3 == 0 ? 230 : 120 + static_cast<int>(i % 7) * 12), cv::FILLED,
                    cv::LINE_AA, kShift);
    }
    return image;
  }

  /// What is found, where an image of a camera is altered; `from`: the camera whose it is.
  std::vector<Finding> Check(
      const std::function<cv::Mat(size_t camera, const cv::Mat& image)>& alter,
      const std::array<size_t, 3>& from = {0, 1, 2}, double speed_sign = 1) const {
    CameraChecks checks(rig_);
    SpeedHistory wheels;
    Rigid3 pose;
    double heading = 0;
    constexpr int kSteps = 100 * 20;
    for (int i = 0; i < kSteps; ++i) {
      const double time = 0.01 * i;
      const Timestamp stamp = Timestamp{1'700'000'000'000'000'000} + time;
      checks.Include(ImuSample{stamp, {0, 0, YawRateAt(time)}, {0, 0, 9.81}});
      if (i % 2 == 0) wheels.Include({stamp, speed_sign * kSpeed, YawRateAt(time)});
      if (i % static_cast<int>(100 / kRate) == 0)
        for (size_t camera = 0; camera < 3; ++camera)
          if (checks.WantsImage(static_cast<int>(camera), stamp))
            checks.IncludeImage(static_cast<int>(camera), stamp,
                                alter(camera, Look(from[camera], pose)));
      heading += 0.01 * YawRateAt(time + 0.005);
      pose.rotation = ExpSo3({0, 0, heading});
      pose.translation += pose.rotation * Eigen::Vector3d(0.01 * kSpeed, 0, 0);
    }
    return checks.Findings(wheels, {"/left", "/right", "/ahead"});
  }

 private:
  Rig rig_;
  std::vector<Eigen::Vector3d> points_;
};

cv::Mat AsItIs(size_t, const cv::Mat& image) { return image; }

TEST(CameraChecks, SayNothingAboutCamerasThatFit) {
  EXPECT_TRUE(TurningCar().Check(AsItIs).empty());
}

TEST(CameraChecks, KnowImagesThatAreUpsideDownOrMirrored) {
  const TurningCar car;
  for (const auto& [code, words] : {std::pair(-1, "upside down"), std::pair(1, "mirrored")}) {
    const std::vector<Finding> found =
        car.Check([code = code](size_t camera, const cv::Mat& image) {
          cv::Mat altered = image;
          if (camera == 1) cv::flip(image, altered, code);
          return altered;
        });
    ASSERT_EQ(found.size(), 1u) << words;
    EXPECT_EQ(found[0].name, kCameraContradicts);
    EXPECT_EQ(found[0].topic, "/right");
    EXPECT_NE(found[0].sentence.find(words), std::string::npos) << found[0].sentence;
  }
}

TEST(CameraChecks, KnowTopicsThatHaveChangedPlaces) {
  const std::vector<Finding> found = TurningCar().Check(AsItIs, {1, 0, 2});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].sentence.find("those of cam1"), std::string::npos) << found[0].sentence;
  EXPECT_NE(found[1].sentence.find("those of cam0"), std::string::npos) << found[1].sentence;
}

TEST(CameraChecks, RefuseALogWhoseCamerasAreAllMirrored) {
  const std::vector<Finding> found = TurningCar().Check([](size_t, const cv::Mat& image) {
    cv::Mat mirrored;
    cv::flip(image, mirrored, 1);
    return mirrored;
  });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].severity, Severity::kUnusable);
  EXPECT_NE(found[0].sentence.find("mirrored"), std::string::npos) << found[0].sentence;
}

TEST(CameraChecks, KnowAnImageThatDoesNotChange) {
  const TurningCar car;
  const cv::Mat frozen = car.Look(1, Rigid3{});
  const std::vector<Finding> found =
      car.Check([&](size_t camera, const cv::Mat& image) { return camera == 1 ? frozen : image; });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].sentence.find("does not change"), std::string::npos) << found[0].sentence;
}

TEST(CameraChecks, LeaveReversedWheelsToTheTrajectory) {
  EXPECT_TRUE(TurningCar().Check(AsItIs, {0, 1, 2}, -1).empty());
}

}  // namespace
}  // namespace parkade
