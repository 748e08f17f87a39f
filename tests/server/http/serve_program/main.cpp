// The service for tests that kill it:   parkade_serve_program serve DATA
// and its worker, which does what the first line of the log says:
//                                       parkade_serve_program work OUT PROGRESS LOG...
//                                       parkade_serve_program compare FROM TO OUT
//                                       parkade_serve_program inspect LOG OUT
//                                       parkade_serve_program pictures LOG INDEX
// and, with ENGINE=slurm, what Slurm runs:  parkade_serve_program run-attempt FOLDER
//   log ok | slow | hang | busy | stubborn | bad-input | crash | silent | no-map

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "server/http/service/serve.h"
#include "server/jobs/slurm/run_on_node.h"
#include "server/store/access/tokens.h"
#include "server/store/data_directory.h"
#include "tests/server/http/fake_worker.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

void Say(const fs::path& progress, const std::string& line) {
  std::ofstream(progress, std::ios::app) << line << "\n";
}

nlohmann::json KeyframeAt(const std::string& second) {
  return {{"time", second + ".000000000"},
          {"camera", "cam0"},
          {"site_from_body", {{"position", {0, 0, 0}}, {"orientation", {0, 0, 0, 1}}}}};
}

void WriteMap(const fs::path& out, const std::vector<fs::path>& logs) {
  std::ofstream mesh(out / "map.glb");
  mesh << "glTF of " << logs.size() << " drives";
  if (const char* size = std::getenv("MAP_MIB")) {
    for (int i = 0; i < std::stoi(size); ++i)
      mesh << std::string(size_t{1} << 20, static_cast<char>(i));
  }
  mesh.close();
  std::ofstream(out / "empty.txt");
  for (const fs::path& log : logs) {
    fs::create_directories(out / log.filename());
    std::ofstream(out / log.filename() / "trajectory.tum") << "0 0 0 0 0 0 0 1\n";
    std::ofstream(out / log.filename() / "diagnostics.json")
        << R"({"start": "10.000000000", "end": 3, "degraded": [], "series": [{"name": "speed",)"
        << R"( "unit": "m/s", "about": "", "times": [0, 1, 2, 3], "values": [1, 9, -5, 1]}]})";
    std::ofstream(out / log.filename() / "keyframes.json")
        << nlohmann::json{{"cameras", nlohmann::json::array()},
                          {"keyframes", {KeyframeAt("10"), KeyframeAt("11"), KeyframeAt("12")}}};
  }
  std::ofstream(out / "report.json")
      << R"({"datum": null, "bounds": {"min": [0, 0, 0], "max": [9, 9, 1]},)"
      << R"( "drives": [{"name": ")" << logs.front().filename().string()
      << R"(", "streams": [{"role": "imu", "topic": "/imu", "delivered": 9, "dropped": {},)"
      << R"( "rate_hz": 100, "longest_gap_s": 0.01}]}]})";
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
  fs::create_directories(out);
  std::ofstream(out / "changes.json")
      << R"({"alignment": {"aligned_by": "drives", "translation": [0, 0, 0], "yaw_deg": 0,)"
      << R"( "horizontal_sigma": 0.01, "height_sigma": 0.01, "num_links": 9, "note": ""},)"
      << R"( "free_space": {"unchanged": 9, "gained": 0, "lost": 0, "freed": 0, "mapped": 0,)"
      << R"( "blocked": 0, "unmapped": 0}, "heights": {"median": 0, "rmse": 0,)"
      << R"( "percentile_95": 0, "raised": 0, "lowered": 0}, "slots": {"kept": 0, "added": [],)"
      << R"( "removed": [], "changed": []}, "drives": {"added": [], "removed": []},)"
      << R"( "trajectories": [], "regions": []})";
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
  nlohmann::json found = {{"name", "?"},
                          {"format", "text"},
                          {"bytes", fs::file_size(log)},
                          {"duration_s", 0},
                          {"topics", nlohmann::json::array()},
                          {"rig", nullptr},
                          {"warnings", nlohmann::json::array()},
                          {"exit_status", 0}};
  found["damage"] = {
      {"ranges", nlohmann::json::array()}, {"lost_messages", 0}, {"is_truncated", false}};
  found["state"] = state == "lossy" || state == "unusable" ? state : "clean";
  found["missing"] = nlohmann::json::array();
  if (!missing.empty()) found["missing"].push_back(missing);
  std::ofstream(out) << found;
  return 0;
}

void Reply(const std::string& line) {
  [[maybe_unused]] const ssize_t sent =
      ::send(STDIN_FILENO, line.data(), line.size(), MSG_NOSIGNAL);
}

/// Hands out pictures as the third line of the log says: "dark", "no-images", "crash", "hang".
/// cam0 has an image each 0.1 s from 10 s to 20 s. What it was asked is appended to `asked` beside
/// the index.
int ServePictures(const fs::path& log, const fs::path& index) {
  std::ifstream stream(log);
  std::string todo;
  for (int line = 0; line < 3; ++line) std::getline(stream, todo);
  const fs::path asked = index.parent_path() / "asked";
  std::ofstream(asked, std::ios::app) << "open\n";
  if (todo == "no-images") {
    Reply("{\"error\": \"the log has no image of any camera\", \"code\": \"invalid_input\"}\n");
    return 1;
  }
  nlohmann::json times = nlohmann::json::array();
  for (int i = 100; i <= 200; ++i) times.push_back(i * std::int64_t{100'000'000});
  nlohmann::json camera = {{"name", "cam0"}, {"times", times}};
  std::ofstream(index) << nlohmann::json{{"cameras", {camera}}};
  Reply("{\"ready\": true}\n");
  std::array<char, 4096> piece{};
  ssize_t count = 0;
  while ((count = ::recv(STDIN_FILENO, piece.data(), piece.size(), 0)) > 0) {
    const nlohmann::json request =
        nlohmann::json::parse(std::string(piece.data(), static_cast<size_t>(count)));
    std::ofstream(asked, std::ios::app) << request.value("time", std::int64_t{0}) << "\n";
    if (todo == "crash") std::abort();
    while (todo == "hang") std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (todo == "dark") {
      Reply("{\"error\": \"the image is damaged\", \"code\": \"invalid_input\"}\n");
    } else if (request.contains("point")) {
      Reply(R"({"views": [{"camera": "cam0", "time": "12.300000000", "pixel": [3, 4],)"
            R"( "distance": 5, "view_angle": 0.5, "resolution": 80}]})"
            "\n");
    } else {
      std::ofstream(request.at("out").get<std::string>())
          << R"({"width": 64, "height": 40, "full_width": 640, "full_height": 400})"
          << "\nJPEG " << request.at("width");
      Reply("{}\n");
    }
  }
  return 0;
}

/// Makes a token for an admin and writes it to `file`.
void WriteAdminToken(const std::string& data, const std::string& file) {
  const DataDirectory directory(data);
  Database database(directory.DatabaseFile());
  Token admin;
  admin.name = "admin";
  admin.role = Role::kAdmin;
  std::ofstream(file) << CreateToken(database, admin).secret;
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
  if (const char* file = std::getenv("ADMIN_TOKEN")) WriteAdminToken(data, file);
  if (const char* reserve = std::getenv("RESERVE")) options.disk_reserve = std::stoll(reserve);
  if (const char* listen = std::getenv("LISTEN")) options.listen = listen;
  if (const char* pause = std::getenv("CRASH_PAUSE"))
    options.job_limits.crash_pauses = {std::chrono::seconds(std::stoi(pause))};
  if (const char* name = std::getenv("PROXY_HOST")) options.proxy_host = name;
  if (const char* prefix = std::getenv("ACCEL_REDIRECT")) options.accel_redirect = prefix;
  if (const char* format = std::getenv("LOG_FORMAT"))
    options.log_format =
        format == std::string("json") ? LogLineFormat::kJson : LogLineFormat::kText;
  options.drain_seconds = 3;
  options.webhooks.limits.allow_private = std::getenv("WEBHOOK_PRIVATE") != nullptr;
  if (const char* pause = std::getenv("WEBHOOK_PAUSE"))
    options.webhooks.pauses.assign(100, std::chrono::milliseconds(std::stoi(pause)));
  if (const char* timeout = std::getenv("WEBHOOK_TIMEOUT"))
    options.webhooks.limits.timeout = std::chrono::milliseconds(std::stoi(timeout));
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
  if (arguments.size() == 3 && arguments[0] == "pictures")
    return parkade::ServePictures(arguments[1], arguments[2]);
  if (arguments.size() == 2 && arguments[0] == "run-attempt")
    return parkade::RunOnNode(arguments[1]);
  if (arguments.size() >= 4 && arguments[0] == "work")
    return parkade::Work(arguments[1], arguments[2], {arguments.begin() + 3, arguments.end()});
  return 2;
}
