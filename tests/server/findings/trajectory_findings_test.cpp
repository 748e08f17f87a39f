#include "server/findings/trajectory_findings.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Cameras whose clocks are off by these [s].
OdometryReport ReportWith(const std::vector<double>& offsets) {
  OdometryReport report;
  for (const double offset : offsets)
    report.calibration.push_back(
        {"cam",
         {{"time_offset", Eigen::VectorXd::Constant(1, offset), Eigen::VectorXd::Constant(1, 1e-3),
           CalibratedQuantity::Status::kRefined}}});
  return report;
}

/// Its cameras, each turned by another angle about the car's vertical axis.
Rig RigOf(const OdometryReport& report) {
  Rig rig;
  for (const CameraCalibration& camera : report.calibration) {
    rig.cameras.emplace_back().name = camera.name;
    rig.cameras.back().body_from_camera.rotation =
        ExpSo3({0, 0, static_cast<double>(rig.cameras.size())});
  }
  return rig;
}

TEST(TrajectoryFindings, CamerasThatAreOffByTheSameShowADelayOfTheImu) {
  const std::vector<Finding> findings =
      TrajectoryFindings(ReportWith({0.041, 0.038, 0.040}), {}, {}, {});

  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].name, "imu_delay");
  EXPECT_EQ(findings[0].severity, Severity::kNote);
  EXPECT_NEAR(findings[0].evidence.at("delay_s"), 0.0395, 1e-9);
  EXPECT_EQ(ToText(findings[0]),
            "the IMU's readings come 40 ms late against all cameras, as behind a low-pass filter, "
            "and are used so: correct its driver's stamps, or timeshift_cam_imu of all cameras");
}

TEST(TrajectoryFindings, CamerasThatDifferOrAreOneOrHardlyOffShowNone) {
  EXPECT_TRUE(TrajectoryFindings(ReportWith({0.041, 0.002}), {}, {}, {}).empty());
  EXPECT_TRUE(TrajectoryFindings(ReportWith({0.040}), {}, {}, {}).empty());
  EXPECT_TRUE(TrajectoryFindings(ReportWith({0.006, 0.006}), {}, {}, {}).empty());
  OdometryReport kept = ReportWith({0.04, 0.04});
  kept.calibration[1].quantities[0].status = CalibratedQuantity::Status::kKept;
  EXPECT_TRUE(TrajectoryFindings(kept, {}, {}, {}).empty());
}

TEST(TrajectoryFindings, WhatIsLeftOutIsSaid) {
  OdometryReport report;
  report.wheels_left_out = "are in km/h";

  const std::vector<Finding> findings =
      TrajectoryFindings(report, RigOf(report), {}, {.doubt = "jump by 30 m"});

  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].sentence, "the wheels are left out: they are in km/h");
  EXPECT_EQ(findings[1].sentence, "GNSS is left out: its fixes jump by 30 m");
}

CameraHealth SeenWith(const std::string& name, double noise_scale) {
  CameraHealth camera;
  camera.name = name;
  camera.frames = camera.frames_used = 100;
  camera.noise_scale = noise_scale;
  return camera;
}

TEST(TrajectoryFindings, CamerasThatDoNotFitThePathAreNamed) {
  OdometryReport report;
  report.cameras = {SeenWith("cam0", 0.3), SeenWith("cam1", 2.5), SeenWith("cam2", 0.6)};

  const std::vector<Finding> one = TrajectoryFindings(report, RigOf(report), {}, {});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].name, "cameras_contradict_path");
  EXPECT_NE(one[0].sentence.find("what cam1 sees does not move"), std::string::npos);

  report.cameras[1].frames_used = 0;
  EXPECT_TRUE(TrajectoryFindings(report, RigOf(report), {}, {}).empty()) << "it was left out";

  report.cameras[1].frames_used = 100;
  report.cameras[0].noise_scale = 4;
  const std::vector<Finding> most = TrajectoryFindings(report, RigOf(report), {}, {});
  ASSERT_EQ(most.size(), 1u);
  EXPECT_NE(most[0].sentence.find("cam0 and cam1 see fits no path"), std::string::npos)
      << most[0].sentence;
}

TEST(TrajectoryFindings, LongPartsWithoutImagesAreSaid) {
  const Timestamp begin{1'700'000'000'000'000'000};
  const std::string blind = std::string(kNoCamera) + "; the IMU alone carries on";
  OdometryReport report;
  report.degraded = {{begin, begin + 0.1, blind}, {begin + 9.0, begin + 12.0, "the wheels"}};
  EXPECT_TRUE(TrajectoryFindings(report, RigOf(report), {}, {}).empty());

  report.degraded.push_back({begin + 20.0, begin + 23.5, blind});
  const std::vector<Finding> findings = TrajectoryFindings(report, RigOf(report), {}, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].sentence,
            "no camera sees anything for 3.5 s: the IMU alone tells the path there");
}

TEST(TrajectoryFindings, MountsThatAreFarOffAreSaid) {
  const auto mount = [](double degrees, CalibratedQuantity::Status status) {
    return CameraCalibration{"cam1",
                             {{"rotation", Eigen::Vector3d(0, degrees * M_PI / 180, 0),
                               Eigen::Vector3d::Constant(0.002), status}}};
  };
  using Status = CalibratedQuantity::Status;
  OdometryReport report;
  report.calibration = {mount(2, Status::kRefined), mount(12, Status::kKept)};
  EXPECT_TRUE(TrajectoryFindings(report, RigOf(report), {}, {}).empty());

  report.calibration = {mount(12, Status::kPartlyRefined)};
  const std::vector<Finding> findings = TrajectoryFindings(report, RigOf(report), {}, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_NE(findings[0].sentence.find("cam1 looks 12 degrees beside"), std::string::npos);
}

TEST(TrajectoryFindings, CamerasThatAreAllTurnedAlikeShowATurnedImu) {
  OdometryReport report;
  for (const char* name : {"cam0", "cam1", "cam2"})
    report.calibration.push_back(
        {name,
         {{"rotation", Eigen::VectorXd::Zero(3), Eigen::Vector3d::Constant(0.002),
           CalibratedQuantity::Status::kRefined}}});
  const Rig rig = RigOf(report);
  const auto turn = [&](std::size_t camera, const Eigen::Vector3d& in_body) {
    report.calibration[camera].quantities[0].change =
        rig.cameras[camera].body_from_camera.rotation.conjugate() * in_body;
  };
  for (std::size_t i = 0; i < 3; ++i) turn(i, {0.01 * static_cast<double>(i), 0, 0.14});

  const std::vector<Finding> alike = TrajectoryFindings(report, rig, {}, {});
  ASSERT_EQ(alike.size(), 1u);
  EXPECT_EQ(alike[0].name, "imu_turned");
  EXPECT_NE(alike[0].sentence.find("the IMU sits yawed by 8 degrees"), std::string::npos)
      << alike[0].sentence;

  turn(1, {0.14, 0, 0});
  EXPECT_EQ(TrajectoryFindings(report, rig, {}, {}).size(), 3u) << "each on its own";
  turn(1, {0, 0, 0});
  EXPECT_EQ(TrajectoryFindings(report, rig, {}, {}).size(), 2u) << "not all";
}

TEST(TrajectoryFindings, AnAccelerometerThatIsFarOffIsSaidWhereNoWheelsTellTheScale) {
  OdometryReport report;
  report.accelerometer_bias = {0.1, -0.1, 0.15};
  EXPECT_TRUE(TrajectoryFindings(report, RigOf(report), {}, {}).empty());

  report.accelerometer_bias.z() = 0.36;
  const std::vector<Finding> findings = TrajectoryFindings(report, RigOf(report), {}, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].sentence,
            "the IMU's accelerations are off by 0.39 m/s2: if it is a matter of their scale, the "
            "path's is off by 3.9 %");
  report.has_wheels = true;
  EXPECT_TRUE(TrajectoryFindings(report, RigOf(report), {}, {}).empty());
}

TEST(TrajectoryFindings, AScaleOfAccelerationsIsSaidWhereGravityAndWheelsAgreeOnIt) {
  OdometryReport report;
  report.has_wheels = true;
  const auto findings_of = [&](double bias, double wheel_scale) {
    report.accelerometer_bias = {0.2, 0.1, bias};
    report.wheel_scale = wheel_scale;
    return TrajectoryFindings(report, RigOf(report), {}, {});
  };
  const std::vector<Finding> findings = findings_of(-0.39, 0.95);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].sentence,
            "the IMU reads gravity 4.0 % too small, and the path is 5.0 % shorter than wheels say: "
            "the scale of accelerations is off, as it seems, and the map's with it");
  EXPECT_NE(findings[0].advice.find("set accelerometer_scale: 1.047 in imu0.yaml"),
            std::string::npos);
  EXPECT_EQ(findings_of(0.3, 1.03).size(), 1u);
  EXPECT_TRUE(findings_of(-0.39, 1.0).empty()) << "its zero is off, which is estimated";
  EXPECT_TRUE(findings_of(-0.05, 0.95).empty()) << "wheels of another size";
  EXPECT_TRUE(findings_of(0.39, 0.95).empty()) << "nothing in common";
}

TEST(TrajectoryFindings, AScaleOfAccelerationsIsToldInTheCarsFrameAndTheRigsUnit) {
  OdometryReport report;
  report.has_wheels = true;
  report.wheel_scale = 1.04;
  report.accelerometer_bias = {0, 0.38, 0};
  Rig rig;
  rig.body_from_imu.rotation = ExpSo3({M_PI / 2, 0, 0});  // its y axis points up
  rig.imu.accelerometer_scale = 9.80665;
  const std::vector<Finding> findings = TrajectoryFindings(report, rig, {}, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_NE(findings[0].advice.find("set accelerometer_scale: 9.435 in"), std::string::npos)
      << findings[0].advice;
  rig.body_from_imu.rotation = ExpSo3({-M_PI / 2, 0, 0});
  EXPECT_TRUE(TrajectoryFindings(report, rig, {}, {}).empty());
}

TEST(TrajectoryFindings, TurnsThatCamerasDoNotSeeAreSaid) {
  const auto findings_of = [](double gain, double delay) {
    return TrajectoryFindings({}, {},
                              {.turn_gain = gain,
                               .turn_gain_sigma = 0.002,
                               .turn_delay = delay,
                               .turn_delay_sigma = 0.004,
                               .leads = {{"cam0", 0.6, 0.1}}},
                              {});
  };
  const std::vector<Finding> gain = findings_of(-0.03, 0.05);
  ASSERT_EQ(gain.size(), 1u);
  EXPECT_EQ(
      ToText(gain[0]),
      "the gyroscope reads turns 3.0 % smaller than the cameras see (to 0.2 %): the map may be "
      "bent: check gyroscope_scale in imu0.yaml, and the focal lengths of the lenses");
  const std::vector<Finding> delay = findings_of(0.009, 0.05);
  ASSERT_EQ(delay.size(), 1u);
  EXPECT_EQ(ToText(delay[0]),
            "the gyroscope's rates come 50 ms behind what the cameras see, as after a low-pass "
            "filter: turn filters of the IMU off, and check its stamps");
  const std::vector<Finding> place = findings_of(0.009, 0.02);
  ASSERT_EQ(place.size(), 1u);
  EXPECT_EQ(place[0].name, "place_off");
}

TEST(TrajectoryFindings, TheCameraThatIsOffTheMostIsNamed) {
  const auto findings_of = [](const std::vector<CameraLead>& leads) {
    return TrajectoryFindings({}, {}, {.leads = leads}, {});
  };
  EXPECT_TRUE(findings_of({{"cam0", 0.2, 0.01}, {"cam1", 0.8, 0.3}}).empty());
  const std::vector<Finding> findings =
      findings_of({{"cam0", 0.4, 0.05}, {"cam1", -0.6, 0.05}, {"cam2", 0.1, 0.05}});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_NE(findings[0].sentence.find("camera cam1 sits 0.6 m farther back"), std::string::npos)
      << findings[0].sentence;
}

TEST(TrajectoryFindings, ABodyThatIsAnotherPointOfTheCarIsAWarning) {
  EXPECT_TRUE(TrajectoryFindings({}, {}, {.body_lead = 1.2, .body_lead_sigma = 0.4}, {}).empty());
  const std::vector<Finding> findings =
      TrajectoryFindings({}, {}, {.body_lead = -1.2, .body_lead_sigma = 0.04}, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_NE(findings[0].sentence.find("1.2 m behind the rear axle"), std::string::npos)
      << findings[0].sentence;
}

TEST(TrajectoryFindings, FixesThatTellNoPlaceAreANote) {
  const std::vector<Finding> findings = TrajectoryFindings({}, {}, {}, {.num_too_vague = 12});

  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].name, "gnss_vague");
  EXPECT_EQ(findings[0].severity, Severity::kNote);
  EXPECT_NE(findings[0].sentence.find("its fixes (12) are too few"), std::string::npos);
}

TEST(TrajectoryFindings, ManyFixesThatDoNotFitTheOthersAreToldAndAFewAreNot) {
  EXPECT_TRUE(TrajectoryFindings({}, {}, {}, {.num_used = 50, .num_apart = 10}).empty());
  const std::vector<Finding> findings =
      TrajectoryFindings({}, {}, {}, {.num_used = 35, .num_apart = 25});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].severity, Severity::kWarning);
  EXPECT_NE(findings[0].sentence.find("GNSS contradicts itself: 25 of 60 fixes are left out"),
            std::string::npos)
      << findings[0].sentence;
}

}  // namespace
}  // namespace parkade
