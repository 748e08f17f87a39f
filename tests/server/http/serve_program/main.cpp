// The service for tests that kill it:   parkade_serve_program serve DATA
// and its worker, which does what the first line of the log says:
//                                       parkade_serve_program work OUT PROGRESS LOG...
//                                       parkade_serve_program compare FROM TO OUT
//                                       parkade_serve_program inspect LOG OUT
// and, with ENGINE=slurm, what Slurm runs:  parkade_serve_program run-attempt FOLDER
//   log ok | slow | hang | busy | stubborn | bad-input | crash | silent | no-map

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "server/http/service/serve.h"
#include "server/jobs/slurm/run_on_node.h"
#include "tests/server/http/fake_worker.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

void Say(const fs::path& progress, const std::string& line) {
  std::ofstream(progress, std::ios::app) << line << "\n";
}

void WriteMap(const fs::path& out, const std::vector<fs::path>& logs) {
  std::ofstream(out / "map.glb") << "glTF of " << logs.size() << " drives";
  std::ofstream(out / "empty.txt");
  for (const fs::path& log : logs) {
    fs::create_directories(out / log.filename());
    std::ofstream(out / log.filename() / "trajectory.tum") << "0 0 0 0 0 0 0 1\n";
  }
  std::ofstream(out / "report.json")
      << R"({"datum": null, "bounds": {"min": [0, 0, 0], "max": [9, 9, 1]},)"
      << R"( "drives": [{"name": ")" << logs.front().filename().string()
      << R"(", "streams": [{"topic": "/imu", "rate": 100}]}]})";
}

int Work(const fs::path& out, const fs::path& progress, const std::vector<fs::path>& logs) {
  std::ifstream stream(logs.front());
  std::string word, todo;
  stream >> word >> todo;
  std::cerr << "working on " << logs.front().filename().string() << ": " << todo << std::endl;
  if (const char* folder = std::getenv("TMPDIR"))
    std::ofstream(fs::path(folder) / "unpacked") << "as a worker leaves it that is killed";
  Say(progress, R"({"stage": "track", "progress": 0.25})");
  if (todo == "bad-input") {
    Say(progress, R"({"error": "the log has no IMU", "code": "invalid_input"})");
    return 1;
  }
  if (todo == "silent") return 3;
  if (todo == "crash") std::abort();
  if (todo == "stubborn") std::signal(SIGTERM, SIG_IGN);
  if (todo == "slow") std::this_thread::sleep_for(std::chrono::seconds(2));
  while (todo == "busy") [[maybe_unused]] volatile int work = 0;
  while (todo == "hang" || todo == "stubborn")
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  Say(progress, R"({"stage": "mesh", "progress": 0.75, "eta": 1.5})");
  if (todo != "no-map") WriteMap(out, logs);
  return 0;
}

/// Two maps differ by their meshes' sizes. Maps of several drives cannot be compared.
int Compare(const fs::path& from, const fs::path& to, const fs::path& out) {
  for (const fs::path& map : {from, to}) {
    std::ifstream mesh(map / "map.glb");
    const std::string content(std::istreambuf_iterator<char>(mesh), {});
    if (content == "glTF of 1 drives") continue;
    std::cerr << "parkade: nothing says how the two maps lie to each other" << std::endl;
    return 1;
  }
  std::ofstream(out.parent_path() / "comparisons", std::ios::app)
      << out.filename().string() << "\n";
  fs::create_directories(out);
  std::ofstream(out / "changes.json") << R"({"free_space": {"gained": 0}})";
  std::ofstream(out / "changes.geojson") << R"({"type": "FeatureCollection", "features": []})";
  std::ofstream(out / "changes.png") << "PNG";
  std::ofstream(out / "changes.pgw") << "0.05";
  return 0;
}

/// What the second line of the log says of it: state, and what is missing.
int Inspect(const fs::path& log, const fs::path& out) {
  std::ifstream stream(log);
  std::string todo, state, missing;
  std::getline(stream, todo);
  std::getline(stream, state);
  state = state.substr(0, 1000);
  if (const size_t space = state.find(' '); space != std::string::npos) {
    missing = state.substr(space + 1);
    state.resize(space);
  }
  if (state == "nonsense") {
    std::ofstream(out) << "{";
    return 0;
  }
  if (state == "slow") std::this_thread::sleep_for(std::chrono::seconds(1));
  if (state == "crash") std::abort();
  if (state == "no-log") {
    std::cerr << "parkade: " << log.filename().string() << " is not a drive log" << std::endl;
    return 1;
  }
  std::ofstream(out) << R"({"name": "?", "topics": [], "state": ")"
                     << (state == "lossy" || state == "unusable" ? state : "clean")
                     << R"(", "missing": [)" << (missing.empty() ? "" : '"' + missing + '"')
                     << "]}";
  return 0;
}

/// Jobs at Slurm of small size, looked at often.
void SetEngine(ServeOptions& options) {
  const char* engine = std::getenv("ENGINE");
  if (engine == nullptr) return;
  options.engine = engine;
  options.num_workers = 4;
  options.slurm.memory_mib = 256;
  options.slurm.cpus = 1;
  options.slurm.time = std::chrono::minutes(10);
  options.slurm.node_program = {fs::read_symlink("/proc/self/exe"), "run-attempt"};
  options.slurm.poll_interval = std::chrono::milliseconds(500);
  options.slurm.exit_patience = std::chrono::milliseconds(2000);
  if (const char* minutes = std::getenv("JOB_MINUTES"))
    options.slurm.time = std::chrono::minutes(std::stoi(minutes));
}

int RunService(const std::string& data) {
  ServeOptions options = FakeServeOptions("/proc/self/exe", data);
  if (const char* reserve = std::getenv("RESERVE")) options.disk_reserve = std::stoll(reserve);
  if (const char* listen = std::getenv("LISTEN")) options.listen = listen;
  if (const char* pause = std::getenv("CRASH_PAUSE"))
    options.job_limits.crash_pauses = {std::chrono::seconds(std::stoi(pause))};
  options.drain_seconds = 3;
  SetEngine(options);
  // As libraries do that start threads before main: this one leaves signals open.
  std::thread([] {
    while (true) std::this_thread::sleep_for(std::chrono::hours(1));
  }).detach();
  try {
    return Serve(options);
  } catch (const Error& error) {
    std::cerr << error.what() << std::endl;
    return 1;
  }
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 2 && arguments[0] == "serve") return parkade::RunService(arguments[1]);
  if (arguments.size() == 4 && arguments[0] == "compare")
    return parkade::Compare(arguments[1], arguments[2], arguments[3]);
  if (arguments.size() == 3 && arguments[0] == "inspect")
    return parkade::Inspect(arguments[1], arguments[2]);
  if (arguments.size() == 2 && arguments[0] == "run-attempt")
    return parkade::RunOnNode(arguments[1]);
  if (arguments.size() >= 4 && arguments[0] == "work")
    return parkade::Work(arguments[1], arguments[2], {arguments.begin() + 3, arguments.end()});
  return 2;
}
