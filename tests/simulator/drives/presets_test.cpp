#include "tests/simulator/drives/presets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/simulator/drives/drive_summary.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/drives/run_suite.h"
#include "tests/simulator/layouts/plan_place.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

TEST(Presets, AreTheSuiteOfThePaperAndSessionsOfOnePlace) {
  std::map<std::string, int> families;
  std::set<std::string> hashes;
  for (const Preset& preset : Presets()) {
    EXPECT_NO_THROW(preset.options.Validate()) << preset.name;
    EXPECT_NO_THROW(QuickForm(preset.options).Validate()) << preset.name;
    hashes.insert(HashOf(preset.options));
    ++families[preset.name.substr(0, preset.name.find_first_of("0123456789"))];
  }
  EXPECT_EQ(families["sim"], 4);
  EXPECT_EQ(families["out"], 16);
  EXPECT_EQ(families["in"], 6);
  for (const std::string& scene : SceneNames()) EXPECT_EQ(families[scene + "-day"], 3);
  EXPECT_EQ(hashes.size(), Presets().size());
  EXPECT_EQ(FindPreset("out3")->options.drive.length, 807);
  EXPECT_EQ(FindPreset("out99"), nullptr);
}

TEST(Presets, DriveTheirLength) {
  for (const Preset& preset : Presets()) {
    const auto& scenes = SceneNames();
    if (std::find(scenes.begin(), scenes.end(), preset.options.scene) == scenes.end()) continue;
    for (const SimulateOptions& options : {preset.options, QuickForm(preset.options)}) {
      const DrivePlan plan = PlanDrive(PlanPlace(options.scene, options.OfScene()), options.drive,
                                       options.duration, static_cast<std::uint64_t>(options.seed));
      EXPECT_NEAR(plan.length, options.drive.length, 0.1 * options.drive.length) << preset.name;
      EXPECT_GE(plan.min_radius, 4.99) << preset.name;
      EXPECT_LE(plan.max_speed, 7.01) << preset.name;
      EXPECT_EQ(plan.is_parked, options.drive.parks) << preset.name;
    }
  }
}

TEST(Presets, TheQuickFormIsShorterAndItsFaultsAreWithinIt) {
  ASSERT_FALSE(Presets().empty());
  for (const Preset& preset : Presets()) {
    const SimulateOptions quick = QuickForm(preset.options);
    EXPECT_LE(quick.drive.length, preset.options.drive.length);
    EXPECT_EQ(quick.cameras.rate, 10);
    const double duration = quick.drive.length / 3;  // about
    EXPECT_LT(quick.faults.occlusion.begin, duration) << preset.name;
    EXPECT_LT(quick.faults.mirror.at, duration) << preset.name;
    EXPECT_LT(quick.faults.darkness.begin, duration) << preset.name;
  }
}

/// Share of `plan` within 5 m of `other`, on the same level.
double SharedWay(const DrivePlan& plan, const DrivePlan& other) {
  const auto places_of = [](const DrivePlan& drive) {
    std::vector<Eigen::Vector3d> places;
    for (double time = 0; time < drive.motion.Duration(); time += 0.2) {
      const Eigen::Vector3d at = drive.motion.WorldFromBody(time).translation;
      if (places.empty() || (places.back() - at).norm() > 0.5) places.push_back(at);
    }
    return places;
  };
  const std::vector<Eigen::Vector3d> places = places_of(plan), others = places_of(other);
  const auto is_shared = [&](const Eigen::Vector3d& place) {
    return std::any_of(others.begin(), others.end(), [&](const Eigen::Vector3d& at) {
      return (at - place).head<2>().norm() < 5 && std::abs((at - place).z()) < 1;
    });
  };
  return static_cast<double>(std::count_if(places.begin(), places.end(), is_shared)) /
         static_cast<double>(places.size());
}

/// So that they can be joined, and it can be judged: in both forms, two the same way, one the other
/// way around.
TEST(Presets, SessionsOfOnePlaceHaveHalfOfTheirWayInCommon) {
  for (const std::string& scene : SceneNames()) {
    for (const bool is_quick : {false, true}) {
      std::vector<DrivePlan> plans;
      int num_opposite = 0;
      for (const int day : {1, 2, 3}) {
        const Preset& preset = *FindPreset(scene + "-day" + std::to_string(day));
        const SimulateOptions options = is_quick ? QuickForm(preset.options) : preset.options;
        plans.push_back(PlanDrive(PlanPlace(options.scene, options.OfScene()), options.drive,
                                  options.duration, static_cast<std::uint64_t>(options.seed)));
        num_opposite += options.drive.is_opposite;
      }
      EXPECT_EQ(num_opposite, 1);
      for (const DrivePlan& plan : plans)
        for (const DrivePlan& other : plans)
          EXPECT_GT(SharedWay(plan, other), 0.5) << scene << (is_quick ? ", quick" : "");
    }
  }
}

TEST(HashOf, ChangesWithEveryOption) {
  SimulateOptions options;
  const std::string before = HashOf(options);
  options.faults.slip.ratio = 0.51;
  EXPECT_NE(HashOf(options), before);
  EXPECT_EQ(HashOf(SimulateOptions{}), before);
  EXPECT_EQ(before.size(), 16u);
}

TEST(RunSuite, KeepsWhatIsThereAndMakesAnewWhatIsNotWhole) {
  const fs::path folder =
      fs::path(testing::TempDir()) / ("parkade_suite_" + std::to_string(getpid()));
  SimulateOptions options;
  options.duration = 10;
  options.ground_texel = 0.1;
  options.cameras.rate = 1;
  options.rig.width = 64;
  options.rig.height = 64;
  const std::vector<Preset> presets = {{"small", "", options}};
  std::ostringstream first, second, third;
  RunSuite(presets, folder, first);
  const std::string log = ReadFile(folder / "small" / "drive.mcap");
  RunSuite(presets, folder, second);
  fs::remove(folder / "small" / "truth" / "summary.json");  // as of a run that was interrupted
  RunSuite(presets, folder, third);

  EXPECT_NE(first.str().find("made in"), std::string::npos);
  EXPECT_NE(second.str().find("there already"), std::string::npos);
  EXPECT_NE(third.str().find("made in"), std::string::npos);
  EXPECT_EQ(ReadFile(folder / "small" / "drive.mcap"), log);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace parkade::simulator
