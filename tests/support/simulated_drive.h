#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "core/files/file.h"
#include "server/ingest/drive/open_drive_log.h"
#include "tests/simulator/drives/simulate_drive.h"

namespace parkade::simulator {

/// Ten seconds of small images, two a second.
inline SimulateOptions SmallDrive() {
  SimulateOptions options;
  options.duration = 10;
  options.ground_texel = 0.1;
  options.cameras.rate = 2;
  options.rig.width = 160;
  options.rig.height = 100;
  options.semantic = true;
  return options;
}

/// One drive in each format, made when a test asks for it.
class SimulatedDrive : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = std::filesystem::path(testing::TempDir()) /
            ("parkade_simulate_" + std::to_string(getpid()));
    std::filesystem::remove_all(root_);
    std::filesystem::create_directories(root_);
    summaries_.clear();
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(root_); }

  static nlohmann::json Simulate(const std::filesystem::path& log, const SimulateOptions& options) {
    return SimulateDrive(options, {root_ / log, {}, {}}, [](const std::string&, double) {});
  }

  static constexpr const char* kFormats[] = {"euroc", "ros2.mcap", "ros1.bag"};

  /// Summary of the small drive in one of the formats.
  static const nlohmann::json& Made(const std::string& name) {
    if (!summaries_.contains(name)) summaries_[name] = Simulate(name, SmallDrive());
    return summaries_[name];
  }
  /// Its folder or file.
  static std::filesystem::path PathOf(const std::string& name) {
    Made(name);
    return root_ / name;
  }

  static std::unique_ptr<RecordedDrive> Open(const std::string& name) {
    return OpenDriveLog(root_ / name, {.rig_folder = DefaultTruthFolder(root_ / name) / "rig"});
  }

  /// Content of every file below `folder`, by relative name.
  static std::map<std::string, std::string> Contents(const std::filesystem::path& folder) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_regular_file())
        contents[std::filesystem::relative(entry.path(), folder)] = ReadFile(entry.path());
    return contents;
  }

  static inline std::filesystem::path root_;
  static inline std::map<std::string, nlohmann::json> summaries_;
};

}  // namespace parkade::simulator
