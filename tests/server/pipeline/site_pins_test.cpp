#include "server/pipeline/site_pins.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "export/trajectory_files.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

const SiteDatum kTruth{48.137154, 11.576124, 519.3};

/// A circle of 20 m around `center`, once in 20 s.
SiteDrive DriveOf(const std::string& name, double begin, const Eigen::Vector3d& center) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * M_PI * i / 400;
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(begin) + 0.05 * i;
    state.world_from_body = {
        Eigen::Quaterniond(Eigen::AngleAxisd(angle + M_PI / 2, Eigen::Vector3d::UnitZ())),
        center + 20 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)};
  }
  SiteDrive drive;
  drive.name = name;
  drive.rig.body_from_imu.translation = {1.2, 0, 0.6};
  drive.odometry = drive.site_from_body_trajectory = Trajectory(states);
  return drive;
}

/// Two drives in the true tangent plane, seen from a site frame that lies anyhow.
SiteMap MapSeenFrom(const Rigid3& site_from_truth) {
  SiteMap map;
  map.drives = {DriveOf("monday", 1000, {0, 0, 0}), DriveOf("tuesday", 2000, {5, 0, 0})};
  for (SiteDrive& drive : map.drives)
    drive.site_from_body_trajectory = drive.site_from_body_trajectory.Transformed(site_from_truth);
  return map;
}

Rigid3 Turned(double yaw, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), translation};
}

class SitePins : public testing::Test {
 protected:
  SitePins() { fs::create_directories(folder_); }
  ~SitePins() override { fs::remove_all(folder_); }

  /// What `parkade map` leaves of a map, as far as pins need it.
  void WriteMap(const SiteMap& map, const SitePinning& pinning) const {
    nlohmann::ordered_json report = {
        {"datum", nullptr}, {"pins", PinsToJson(pinning)}, {"drives", nlohmann::json::array()}};
    for (const SiteDrive& drive : map.drives) {
      report["drives"].push_back({{"name", drive.name}});
      fs::create_directories(folder_ / drive.name);
      WriteTum(SampleFinalTrajectory(drive), folder_ / drive.name / "trajectory.tum");
    }
    WriteFileAtomically(folder_ / "report.json", report.dump());
  }

  /// As a reviewer would write it who knows where the point lies.
  static std::string Pin(const Rigid3& site_from_truth, const Eigen::Vector3d& true_point) {
    const Eigen::Vector3d point = site_from_truth * true_point;
    const Geodetic place = GeodeticFromSite(kTruth, true_point);
    char text[200];
    std::snprintf(text, sizeof text, "%.6f,%.6f,%.6f=%.10f,%.10f,%.4f", point.x(), point.y(),
                  point.z(), place.latitude_deg, place.longitude_deg, place.altitude);
    return text;
  }

  std::string SentenceOf(const std::vector<std::string>& pins) const {
    try {
      AnchorPins(pins, folder_, {});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput) << error.what();
      return error.what();
    }
    return "";
  }

  /// [m] worst over the drives' poses, on Earth.
  static double ErrorOf(const SiteMap& map) {
    double worst = 0;
    const SiteMap truth = MapSeenFrom({});
    for (const SiteDrive& drive : map.drives) {
      const auto of_truth =
          std::find_if(truth.drives.begin(), truth.drives.end(),
                       [&](const SiteDrive& candidate) { return candidate.name == drive.name; });
      for (const TrajectoryState& state : drive.site_from_body_trajectory.states()) {
        const Eigen::Vector3d found = EarthFromSite(*map.datum) * state.world_from_body.translation;
        const Rigid3 true_pose = *of_truth->site_from_body_trajectory.At(state.time);
        worst = std::max(worst, (found - EarthFromSite(kTruth) * true_pose.translation).norm());
      }
    }
    return worst;
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("pins_" + std::to_string(::getpid()));
  const Rigid3 first_frame_ = Turned(1, {100, -40, 3});
  const std::vector<std::string> texts_ = {Pin(first_frame_, {22, 3, 0.5}),
                                           Pin(first_frame_, {-25, -4, 0})};
};

TEST_F(SitePins, ReachEarthThroughABuildWithAnotherFrame) {
  WriteMap(MapSeenFrom(first_frame_), {});
  SiteMap map = MapSeenFrom(Turned(-2, {7, 8, 9}));
  const SitePinning pinning = PinSite(AnchorPins(texts_, folder_, {}), {}, map);

  ASSERT_TRUE(pinning.fit && map.datum && map.placement);
  EXPECT_LT(ErrorOf(map), 2e-3);
  EXPECT_TRUE(pinning.warnings.empty());
  EXPECT_FALSE(pinning.pinned_from_gnss) << "there is no GNSS";
  EXPECT_LT(pinning.pins[0].place.point_in_site.norm(), 1e-3) << "the datum is at the first pin";
}

TEST_F(SitePins, AreInheritedAndOutliveTheDriveTheyWereSetIn) {
  WriteMap(MapSeenFrom(first_frame_), {});
  std::vector<std::string> in_monday;
  for (const std::string& text : texts_) in_monday.push_back("monday:" + text);
  SiteMap pinned = MapSeenFrom(Turned(-2, {7, 8, 9}));
  WriteMap(pinned, PinSite(AnchorPins(in_monday, folder_, {}), {}, pinned));

  const std::vector<SitePin> inherited = ReadPins(folder_);
  ASSERT_EQ(inherited.size(), 2U);
  ASSERT_EQ(inherited[0].anchors.size(), 2U) << "tuesday passes near, too";
  SiteMap later = MapSeenFrom(Turned(0.4, {1, 2, 3}));
  later.drives.erase(later.drives.begin());
  const SitePinning pinning = PinSite(inherited, {}, later);
  ASSERT_TRUE(pinning.fit);
  EXPECT_LT(ErrorOf(later), 2e-3);
}

TEST_F(SitePins, WithoutTheirDrivesLeaveTheMapAsItWas) {
  WriteMap(MapSeenFrom(first_frame_), {});
  const std::vector<SitePin> pins = AnchorPins(texts_, folder_, {});
  SiteMap other;
  other.drives = {DriveOf("friday", 3000, {0, 0, 0})};
  const SitePinning pinning = PinSite(pins, {}, other);

  EXPECT_FALSE(pinning.fit || other.datum);
  ASSERT_EQ(pinning.warnings.size(), 1U);
  EXPECT_NE(pinning.warnings[0].find("the pins are not used"), std::string::npos);
  EXPECT_EQ(PinsToJson(pinning).size(), 2U) << "kept, as the drive may come back";
  EXPECT_TRUE(GeoreferenceToJson(other, pinning).is_null());
}

TEST_F(SitePins, OverruleGnssAndTellHowFarItWasOff) {
  WriteMap(MapSeenFrom(first_frame_), {});
  SiteMap map = MapSeenFrom(Turned(0.1, {30, 0, 0}));  // GNSS has it 30 m too far east, and turned
  map.datum = kTruth;
  const SitePinning pinning = PinSite(AnchorPins(texts_, folder_, {}), {}, map);

  EXPECT_LT(ErrorOf(map), 2e-3);
  const auto json = GeoreferenceToJson(map, pinning);
  EXPECT_EQ(json.at("source"), "pins");
  EXPECT_NEAR(json.at("pins_from_gnss").at("position").at(0), -30, 0.6);
  EXPECT_NEAR(json.at("pins_from_gnss").at("yaw"), -0.1, 1e-3);
  ASSERT_EQ(pinning.warnings.size(), 1U);
  EXPECT_NE(pinning.warnings[0].find("30 m from where GNSS has it"), std::string::npos)
      << pinning.warnings[0];
}

TEST_F(SitePins, ThatMakeNoSenseAreRefusedInOneSentence) {
  WriteMap(MapSeenFrom(first_frame_), {});
  const auto expect = [&](const std::vector<std::string>& pins, const std::string& part) {
    EXPECT_NE(SentenceOf(pins).find(part), std::string::npos)
        << SentenceOf(pins) << " has no " << part;
  };
  EXPECT_EQ(SentenceOf(texts_), "");
  expect({texts_[0]}, "two points or more");
  expect({texts_[0], texts_[0]}, "of each other");
  expect({texts_[0], "nobody:" + texts_[1]}, "no drive 'nobody', but: monday, tuesday");
  expect({texts_[0], Pin(first_frame_, {300, 40, 0})}, "m from where a drive passed");
  expect({texts_[0], Pin(Turned(1, {100, -35, 3}), {-25, -4, 0})}, "do not fit each other");
  for (const char* text :
       {"", "1,2,3", "1,2=48,11", "1,2,3=48", "1,2,3=48,11,5,6", "1,2,x=48,11", "1,2,3=48,11,"})
    expect({texts_[0], text}, "is not [DRIVE:]X,Y,Z=LAT,LON[,HEIGHT]");
  expect({texts_[0], "1,2,3=95,11"}, "latitude of pin 2");
}

}  // namespace
}  // namespace parkade
