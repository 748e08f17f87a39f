#include "server/ingest/checks/camera_checks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "server/ingest/checks/gyroscope_findings.h"
#include "server/ingest/checks/wheel_checks.h"

namespace parkade {
namespace {

constexpr double kSpeed = 3, kRate = 5;  // [m/s], [Hz]

double YawRateAt(double time) { return 0.4 * std::sin(time); }

/// How the car leans on its springs.
Eigen::Quaterniond LeanAt(double time) {
  return ExpSo3({0.02 * std::sin(5 * time), 0.03 * std::sin(4 * time), 0});
}

const Timestamp kBegin{1'700'000'000'000'000'000};

/// What is wrong with a log.
struct Fault {
  std::function<cv::Mat(size_t camera, const cv::Mat& image)> alter = nullptr;
  std::array<size_t, 3> from = {0, 1, 2};  ///< the camera whose images each one has
  double speed_sign = 1;
  Eigen::Vector3d gains = Eigen::Vector3d::Ones();  ///< of the gyroscope
  double imu_delay = 0;                             ///< [s]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  bool has_wheels = true;
  double lens_size = 1;  ///< of the images for which the rig has the second camera's lens
};

/// Three cameras that look left, right and ahead, 1 m above the ground, in a car that drives
/// curves and leans.
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

  /// Gives checks what was recorded; the wheels' samples in return.
  SpeedHistory Record(const Fault& fault, CameraChecks& checks) const {
    SpeedHistory wheels;
    Rigid3 pose;
    double heading = 0;
    constexpr int kSteps = 100 * 20;
    for (int i = 0; i < kSteps; ++i) {
      const double time = 0.01 * i;
      const Timestamp stamp = kBegin + time;
      const Eigen::Vector3d rate =
          LogSo3(LeanAt(time - 0.005).conjugate() * ExpSo3({0, 0, 0.01 * YawRateAt(time)}) *
                 LeanAt(time + 0.005)) /
          0.01;
      checks.Include(ImuSample{
          stamp + fault.imu_delay, rate.cwiseProduct(fault.gains) + fault.bias, {0, 0, 9.81}});
      if (i % 2 == 0) wheels.Include({stamp, fault.speed_sign * kSpeed, YawRateAt(time)});
      if (i % static_cast<int>(100 / kRate) == 0)
        for (size_t camera = 0; camera < 3; ++camera)
          if (checks.WantsImage(static_cast<int>(camera), stamp)) {
            const cv::Mat seen = Look(fault.from[camera], Leaning(pose, time));
            cv::Mat image = fault.alter ? fault.alter(camera, seen) : seen;
            checks.IncludeImage(static_cast<int>(camera), stamp,
                                {[image] { return image; }, image.total()});
          }
      heading += 0.01 * YawRateAt(time + 0.005);
      pose.rotation = ExpSo3({0, 0, heading});
      pose.translation += pose.rotation * Eigen::Vector3d(0.01 * kSpeed, 0, 0);
    }
    checks.FollowPairs();
    return wheels;
  }

  std::vector<Finding> Check(const Fault& fault) const {
    Rig rig = rig_;
    const double size = fault.lens_size;
    rig.cameras[1].model =
        CameraModel(PinholeProjection{160 * size, 160 * size, 159.5 * size, 99.5 * size}, 320, 200);
    CameraChecks checks(rig);
    const SpeedHistory wheels = Record(fault, checks);
    return checks.Findings(fault.has_wheels ? wheels : checks.Speeds(),
                           {"/left", "/right", "/ahead"}, "/imu");
  }

 private:
  static Rigid3 Leaning(const Rigid3& pose, double time) {
    return {pose.rotation * LeanAt(time), pose.translation};
  }

  Rig rig_;
  std::vector<Eigen::Vector3d> points_;
};

TEST(ImagePairs, DecodeOnlyThePairsThatAreLeft) {
  const TurningCar car;
  ImagePairs pairs(car.rig().cameras[0]);
  std::atomic<int> num_decoded = 0;
  for (int i = 0; i < 2000; ++i) {
    const Timestamp time = kBegin + 0.1 * i;
    if (!pairs.Wants(time)) continue;
    const cv::Mat image = i < 20 ? cv::Mat() : car.Look(0, {{}, {0.05 * i, 0, 0}});
    pairs.Include(time, {[=, &num_decoded] { return ++num_decoded, image; }, 10});
  }
  const size_t num_waiting = pairs.num_waiting_bytes() / 20;

  pairs.Follow();

  EXPECT_GT(num_waiting, 20u);
  EXPECT_LT(num_waiting, 42u);
  EXPECT_EQ(num_decoded.load(), static_cast<int>(2 * num_waiting));
  EXPECT_EQ(pairs.num_waiting_bytes(), 0u);
  // Those of the first two seconds cannot be decoded.
  ASSERT_LT(pairs.pairs().size(), num_waiting);
  EXPECT_GT(pairs.pairs().size(), num_waiting - 3);
  EXPECT_GE(pairs.pairs().front().first - kBegin, 2 - 1e-9);
  for (const ImagePair& pair : pairs.pairs()) EXPECT_NEAR(pair.second - pair.first, 0.1, 1e-6);
}

TEST(CameraChecks, SayNothingAboutCamerasThatFit) { EXPECT_TRUE(TurningCar().Check({}).empty()); }

TEST(CameraChecks, SeeTheCarMoveWithoutWheels) {
  const TurningCar car;
  CameraChecks checks(car.rig());
  car.Record({}, checks);

  const SpeedHistory speeds = checks.Speeds();

  ASSERT_GT(speeds.samples().size(), 50u);
  int num_right_turns = 0, num_right_speeds = 0, num_forward = 0;
  for (const WheelSample& sample : speeds.samples()) {
    const double time = sample.time - kBegin;
    num_right_turns += std::abs(sample.yaw_rate - YawRateAt(time)) < 0.08 ? 1 : 0;
    num_right_speeds += std::abs(sample.forward_speed - kSpeed) < 0.3 * kSpeed ? 1 : 0;
    num_forward += sample.forward_speed > 0 ? 1 : 0;
  }
  const auto count = static_cast<double>(speeds.samples().size());
  EXPECT_GT(num_right_turns, 0.9 * count);
  EXPECT_GT(num_forward, 0.95 * count);
  // Where the car hardly turns, nothing tells how fast it is.
  EXPECT_GT(num_right_speeds, 0.5 * count);
}

TEST(CameraChecks, ExamineAGyroscopeWithoutWheels) {
  const TurningCar car;
  const auto check = [&](const Eigen::Vector3d& gains, double imu_delay) {
    return car.Check({.gains = gains, .imu_delay = imu_delay, .has_wheels = false});
  };
  EXPECT_TRUE(check({1, 1, 1}, 0).empty());

  const std::vector<Finding> reversed = check({1, 1, -1}, 0);
  ASSERT_EQ(reversed.size(), 1u);
  EXPECT_EQ(reversed[0].name, "imu_axes");
  EXPECT_NE(reversed[0].sentence.find("about z"), std::string::npos) << reversed[0].sentence;

  const std::vector<Finding> large = check({1.05, 1.05, 1.05}, 0);
  ASSERT_EQ(large.size(), 1u);
  EXPECT_EQ(large[0].name, kGyroscopeGain);
  EXPECT_NEAR(large[0].evidence.at(kRateCorrection), 1 / 1.05, 0.015);

  const std::vector<Finding> late = check({1, 1, 1}, 0.1);
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0].name, kImuLate);
  EXPECT_NEAR(late[0].evidence.at(kDelay), 0.1, 0.01);
}

TEST(GyroscopeFit, OfAStreetDoesNotTellAGain) {
  GyroscopeFit fit;
  fit.true_from_read *= 0.91;
  fit.sigma.setConstant(0.035);
  fit.turned = 0.6;  // around corners
  EXPECT_NEAR(GainOf(fit).sigma, 0.02, 0.001);
  EXPECT_EQ(CheckGyroscope(fit, "/imu").size(), 0u) << "points do not lie near their planes";
  fit.explained = 1;
  EXPECT_EQ(CheckGyroscope(fit, "/imu").size(), 1u);

  fit.turned = 0.048;  // over 60 m of a street
  EXPECT_GT(GainOf(fit).sigma, 0.04);
  EXPECT_EQ(CheckGyroscope(fit, "/imu").size(), 0u);
}

TEST(CameraChecks, SeeTheCarMoveWhileWheelsSayItStands) {
  const TurningCar car;
  CameraChecks checks(car.rig());
  const SpeedHistory wheels = car.Record({}, checks);
  SpeedHistory dead;
  for (const WheelSample& sample : wheels.samples())
    dead.Include({sample.time, sample.time - kBegin < 10 ? sample.forward_speed : 0, 0});

  EXPECT_FALSE(CheckSticking(wheels, checks.NumMovingAtRest(wheels), "/odom"));
  const auto found = CheckSticking(dead, checks.NumMovingAtRest(dead), "/odom");
  ASSERT_TRUE(found);
  EXPECT_NE(found->sentence.find("say 0 m/s in"), std::string::npos) << found->sentence;
}

TEST(CameraChecks, KnowImagesThatAreUpsideDownOrMirrored) {
  const TurningCar car;
  for (const auto& [code, words] : {std::pair(-1, "upside down"), std::pair(1, "mirrored")}) {
    const std::vector<Finding> found =
        car.Check({.alter = [code = code](size_t camera, const cv::Mat& image) {
          cv::Mat altered = image;
          if (camera == 1) cv::flip(image, altered, code);
          return altered;
        }});
    ASSERT_EQ(found.size(), 1u) << words;
    EXPECT_EQ(found[0].name, kCameraContradicts);
    EXPECT_EQ(found[0].topic, "/right");
    EXPECT_NE(found[0].sentence.find(words), std::string::npos) << found[0].sentence;
  }
}

TEST(CameraChecks, KnowTopicsThatHaveChangedPlaces) {
  const std::vector<Finding> found = TurningCar().Check({.from = {1, 0, 2}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].sentence.find("those of cam1"), std::string::npos) << found[0].sentence;
  EXPECT_NE(found[1].sentence.find("those of cam0"), std::string::npos) << found[1].sentence;
}

TEST(CameraChecks, KnowALensThatIsCalibratedForImagesOfAnotherSize) {
  const std::vector<Finding> found = TurningCar().Check({.lens_size = 4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].topic, "/right");
  EXPECT_NE(found[0].sentence.find("for images 4 times as large"), std::string::npos)
      << found[0].sentence;
}

TEST(CameraChecks, RefuseALogWhoseCamerasAreAllMirrored) {
  const std::vector<Finding> found = TurningCar().Check({.alter = [](size_t, const cv::Mat& image) {
    cv::Mat mirrored;
    cv::flip(image, mirrored, 1);
    return mirrored;
  }});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].severity, Severity::kUnusable);
  EXPECT_NE(found[0].sentence.find("mirrored"), std::string::npos) << found[0].sentence;
}

TEST(CameraChecks, KnowAnAxisOfTheGyroscopeThatIsReversed) {
  const TurningCar car;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();
    signs[axis] = -1;
    const std::vector<Finding> found = car.Check({.gains = signs});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].name, "imu_axes");
    EXPECT_NEAR(found[0].evidence.at("turned_over_read"), -1, 0.3) << found[0].sentence;
  }
}

TEST(CameraChecks, MeasureAGyroscopesGain) {
  for (const double gain : {0.9, 0.97, 1.03}) {
    const std::vector<Finding> found =
        TurningCar().Check({.gains = Eigen::Vector3d::Constant(gain)});
    ASSERT_EQ(found.size(), 1u) << gain;
    EXPECT_EQ(found[0].name, kGyroscopeGain);
    EXPECT_NEAR(found[0].evidence.at(kRateCorrection), 1 / gain, 0.01);
  }
}

TEST(CameraChecks, MeasureHowLateAnImuIs) {
  for (const double delay : {0.1, -0.06}) {
    const std::vector<Finding> found = TurningCar().Check({.imu_delay = delay});
    ASSERT_EQ(found.size(), 1u) << delay;
    EXPECT_EQ(found[0].name, kImuLate);
    EXPECT_NEAR(found[0].evidence.at(kDelay), delay, 0.015);
  }
}

TEST(CameraChecks, KnowAnImageThatDoesNotChange) {
  const TurningCar car;
  const cv::Mat frozen = car.Look(1, Rigid3{});
  const std::vector<Finding> found = car.Check(
      {.alter = [&](size_t camera, const cv::Mat& image) { return camera == 1 ? frozen : image; }});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].sentence.find("does not change"), std::string::npos) << found[0].sentence;
}

TEST(CameraChecks, KnowAGyroscopeThatReadsARateAtRest) {
  const Eigen::Vector3d bias(0.1, -0.2, 0.2);
  const std::vector<Finding> found = TurningCar().Check({.bias = bias});
  ASSERT_EQ(found.size(), 1u) << "no camera is blamed";
  EXPECT_EQ(found[0].name, "gyroscope_bias");
  EXPECT_NEAR(found[0].evidence.at("bias_rad_s"), 0.3, 0.02);
}

TEST(CameraChecks, TakeAnImageThatIsRepeatedOnceForNoRest) {
  for (const int second_of_pair : {12, 14, 16}) {
    std::array<cv::Mat, 3> last;
    std::array<int, 3> count{};
    const auto found = TurningCar().Check({.alter = [&](size_t camera, const cv::Mat& image) {
      const bool is_repeated = ++count[camera] == second_of_pair;
      return last[camera] = is_repeated ? last[camera] : image;
    }});

    EXPECT_TRUE(found.empty()) << second_of_pair << ": " << found[0].sentence;
  }
}

TEST(CameraChecks, KnowCamerasThatHaveAllChangedPlaces) {
  const std::vector<Finding> found = TurningCar().Check({.from = {1, 2, 0}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].severity, Severity::kUnusable);
}

TEST(CameraChecks, KnowACameraThatShowsNoise) {
  cv::RNG random(3);
  const std::vector<Finding> found =
      TurningCar().Check({.alter = [&](size_t camera, const cv::Mat& image) {
        cv::Mat noise(image.size(), CV_8UC1);
        if (camera == 1) random.fill(noise, cv::RNG::UNIFORM, 0, 256);
        return camera == 1 ? noise : image;
      }});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].topic, "/right");
  EXPECT_NE(found[0].sentence.find("found again"), std::string::npos) << found[0].sentence;
}

TEST(CameraChecks, LeaveReversedWheelsToTheTrajectory) {
  EXPECT_TRUE(TurningCar().Check({.speed_sign = -1}).empty());
}

}  // namespace
}  // namespace parkade
