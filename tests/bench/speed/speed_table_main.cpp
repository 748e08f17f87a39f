// What a map costs, stage by stage, beside the least that it could cost on this machine.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/files/file.h"
#include "server/ingest/drive/open_drive_log.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/speed/run_program.h"
#include "tests/bench/speed/speed_floor.h"

namespace parkade {
namespace {

constexpr const char* kFooter =
    R"(Runs `parkade map` on the drive, and in between times OpenCV on the drive's own images: "x" is processor time per image
divided by that of decoding it and following its corners. Of several runs the least of each number counts, as other
programs only add. --history appends a line of JSON with the commit to a file, for a curve over time.
Example: parkade-speed-table build/release/server/parkade drive.mcap --rig drive.truth/rig --runs 2)";

struct CommandLine {
  std::filesystem::path program, log, rig, json, history;
  std::string commit;
  std::vector<std::string> options;
  int num_runs = 1, num_threads = 2, sample = 400;
};

/// Stages that are told as one.
struct Row {
  std::string name;
  std::vector<std::string> stages;
};

const std::vector<Row>& Rows() {
  static const std::vector<Row> rows = {
      {"track", {"track"}},
      {"observe ground", {"observe ground"}},
      {"loops, refine, join", {"close loops", "refine", "join drives"}},
      {"fuse to write",
       {"fuse surface", "mesh", "texture", "slots by drive", "find markings", "write"}},
  };
  return rows;
}

struct Measured {
  SpeedFloor floor;
  ProgramCost map;
  std::map<std::string, double> rows;  ///< [s] of processor time
};

Measured MeasureOnce(const CommandLine& line, const DriveLog& log,
                     const std::filesystem::path& scratch) {
  std::filesystem::remove_all(scratch);
  std::vector<std::string> command = {
      line.program.string(), "map",     line.log.string(), "--out",
      scratch.string(),      "--quiet", "--threads",       std::to_string(line.num_threads)};
  if (!line.rig.empty()) command.insert(command.end(), {"--rig", line.rig.string()});
  command.insert(command.end(), line.options.begin(), line.options.end());
  Measured measured;
  measured.map = RunProgram(command);
  Require(
      measured.map.exit_status == 0, ErrorCode::kInvalidInput,
      "'" + line.program.string() + " map' ended with " + std::to_string(measured.map.exit_status));
  const auto report = nlohmann::json::parse(ReadFile(scratch / "report.json", size_t{64} << 20));
  for (const nlohmann::json& stage : report.at("stages"))
    for (const Row& row : Rows())
      if (std::find(row.stages.begin(), row.stages.end(), stage.at("name")) != row.stages.end())
        measured.rows[row.name] += stage.at("processor_seconds").get<double>();
  measured.floor = MeasureSpeedFloor(log, scratch, line.sample);
  std::filesystem::remove_all(scratch);
  return measured;
}

void TakeLeast(const Measured& other, Measured& least) {
  for (const auto& [name, seconds] : other.rows)
    least.rows[name] = std::min(least.rows.at(name), seconds);
  const auto take = [](const auto& from, auto& to) { to = std::min(to, from); };
  take(other.floor.follow, least.floor.follow);
  take(other.floor.network, least.floor.network);
  take(other.floor.copy, least.floor.copy);
  take(other.map.seconds, least.map.seconds);
  take(other.map.processor_seconds, least.map.processor_seconds);
  take(other.map.peak_memory_bytes, least.map.peak_memory_bytes);
}

nlohmann::json ToJson(const Measured& measured, const CommandLine& line, double duration) {
  const auto images = static_cast<double>(measured.floor.images);
  nlohmann::json json = {{"commit", line.commit},
                         {"images", measured.floor.images},
                         {"duration_s", duration},
                         {"threads", line.num_threads},
                         {"seconds", measured.map.seconds},
                         {"processor_seconds", measured.map.processor_seconds},
                         {"peak_memory_bytes", measured.map.peak_memory_bytes},
                         {"floor_ms", 1000 * measured.floor.follow},
                         {"network_ms", 1000 * measured.floor.network},
                         {"copy_ms", 1000 * measured.floor.copy}};
  if (measured.map.instructions) json["instructions"] = *measured.map.instructions;
  for (const Row& row : Rows()) {
    const double seconds = measured.rows.at(row.name);
    json["stages"].push_back({{"name", row.name},
                              {"processor_seconds", seconds},
                              {"ms_per_image", 1000 * seconds / images},
                              {"ratio", seconds / images / measured.floor.follow}});
  }
  return json;
}

void Print(const nlohmann::json& json) {
  const double images = json["images"], floor = json["floor_ms"];
  std::printf("%-22s %10s %10s %8s\n", "", "seconds", "ms/image", "x");
  for (const nlohmann::json& stage : json["stages"])
    std::printf("%-22s %10.1f %10.2f %8.2f\n", stage["name"].get<std::string>().c_str(),
                stage["processor_seconds"].get<double>(), stage["ms_per_image"].get<double>(),
                stage["ratio"].get<double>());
  const double all = json["processor_seconds"];
  std::printf("%-22s %10.1f %10.2f %8.2f\n", "all", all, 1000 * all / images,
              1000 * all / images / floor);
  std::printf(
      "decode and follow %.2f ms, network %.1f ms, copy of the map %.0f ms; %.0f images\n"
      "%d threads: %.1f s for a drive of %.1f s (%.2f x real time), peak %.0f MB\n",
      floor, json["network_ms"].get<double>(), json["copy_ms"].get<double>(), images,
      json["threads"].get<int>(), json["seconds"].get<double>(), json["duration_s"].get<double>(),
      json["duration_s"].get<double>() / json["seconds"].get<double>(),
      json["peak_memory_bytes"].get<double>() / 1e6);
  if (json.contains("instructions"))
    std::printf("%.1f billion instructions\n", json["instructions"].get<double>() / 1e9);
}

int Run(const CommandLine& line) {
  const auto log = OpenDriveLog(line.log, {.rig_folder = line.rig});
  const std::filesystem::path scratch =
      std::filesystem::temp_directory_path() / ("parkade-speed-" + std::to_string(::getpid()));
  Measured least;
  for (int run = 0; run < line.num_runs; ++run) {
    const Measured measured = MeasureOnce(line, *log, scratch);
    if (run == 0)
      least = measured;
    else
      TakeLeast(measured, least);
  }
  const nlohmann::json json = ToJson(least, line, log->span().Seconds());
  Print(json);
  if (!line.json.empty()) WriteFileAtomically(line.json, json.dump(2) + "\n");
  if (!line.history.empty()) std::ofstream(line.history, std::ios::app) << json.dump() << "\n";
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  parkade::CommandLine line;
  CLI::App app("Processor time of each stage of a map, as a ratio", "parkade-speed-table");
  app.footer(parkade::kFooter);
  app.add_option("program", line.program, "parkade")->required();
  app.add_option("log", line.log, "Of a drive")->required();
  app.add_option("--rig", line.rig, "Its rig; default: from the log");
  app.add_option("--map-options", line.options, "Passed on to `parkade map`");
  app.add_option("--runs", line.num_runs)->capture_default_str()->check(CLI::Range(1, 20));
  app.add_option("--sample", line.sample, "Images that OpenCV follows")->capture_default_str();
  app.add_option("--json", line.json, "FILE");
  app.add_option("--history", line.history, "FILE that a line is appended to");
  app.add_option("--commit", line.commit, "What the line says of the program");
  app.add_option("--threads", line.num_threads)->capture_default_str();
  return parkade::RunBench(app, argc, argv, line.num_threads, [&] { return parkade::Run(line); });
}
