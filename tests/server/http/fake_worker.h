#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "server/http/service/serve.h"

namespace parkade {

/// A service whose worker is serve_program/main.cpp, on a free port. A log is a
/// file that begins with "log "; its first line tells the worker what to do.
inline ServeOptions FakeServeOptions(const std::filesystem::path& program,
                                     const std::filesystem::path& data) {
  ServeOptions options;
  options.data = data;
  options.listen = "127.0.0.1:0";
  options.disk_reserve = 0;
  options.job_limits.crash_pauses = {};
  options.merge_drives = false;  // a log tells the worker what to do: one at a time
  const std::string worker =
      std::filesystem::exists(program) && std::filesystem::is_symlink(program)
          ? std::filesystem::read_symlink(program).string()
          : program.string();
  options.job_command = [worker](const JobSpec& spec) {
    std::vector<std::string> command = {worker, "work", spec.out, spec.progress};
    command.insert(command.end(), spec.logs.begin(), spec.logs.end());
    return command;
  };
  options.compare_command = [worker](const std::filesystem::path& from,
                                     const std::filesystem::path& to,
                                     const std::filesystem::path& out) {
    return std::vector<std::string>{worker, "compare", from, to, out};
  };
  options.inspect_command = [worker](const std::filesystem::path& log,
                                     const std::optional<std::filesystem::path>&,
                                     const std::filesystem::path& out) {
    return std::vector<std::string>{worker, "inspect", log, out};
  };
  options.pictures.command = [worker](const std::filesystem::path& log,
                                      const std::optional<std::filesystem::path>&,
                                      const std::filesystem::path& index) {
    return std::vector<std::string>{worker, "pictures", log, index};
  };
  options.check_log = [](const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string word;
    stream >> word;
    Require(word == "log", ErrorCode::kInvalidInput,
            "'" + file.filename().string() + "' is not a drive log");
  };
  options.check_rig = [](const std::filesystem::path& folder) {
    std::ifstream stream(folder / "imu0.yaml");
    std::string word;
    stream >> word;
    Require(word == "rostopic:", ErrorCode::kInvalidInput, "imu0.yaml names no rostopic");
  };
  return options;
}

}  // namespace parkade
