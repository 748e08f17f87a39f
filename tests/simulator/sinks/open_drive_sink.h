#pragma once

#include <filesystem>
#include <memory>

#include "core/rig.h"
#include "tests/simulator/sinks/drive_sink.h"

namespace parkade::simulator {

/// Throws Error{kUsage} when `out` is a file, or a folder with something in it.
void RequireNewOutput(const std::filesystem::path& out);

/// The format follows from the name: .bag (ROS 1), .mcap (ROS 2), anything else
/// an EuRoC folder. Throws what RequireNewOutput throws.
std::unique_ptr<DriveSink> OpenDriveSink(const std::filesystem::path& out, const Rig& rig);

/// The rig with the stream names that a log at `out` has: EuRoC's folder names or ROS topics.
Rig RigForOutput(const Rig& rig, const std::filesystem::path& out);

/// True for .bag and .mcap.
bool IsLogFile(const std::filesystem::path& out);

}  // namespace parkade::simulator
