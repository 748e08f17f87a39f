#include "server/jobs/slurm/node_files.h"

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/files/file.h"
#include "server/store/data_directory.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Kind = WorkerExit::Kind;

constexpr std::size_t kMaxExitBytes = 65536;
constexpr std::string_view kExit = ".exit.json";
constexpr const char* kPreparation = "-prepare-";
constexpr const char* kScript = "#!/bin/sh\nexec \"$@\"\n";

constexpr std::array<std::pair<Kind, const char*>, 5> kKinds = {{{Kind::kDone, "done"},
                                                                 {Kind::kFailed, "failed"},
                                                                 {Kind::kCrashed, "crashed"},
                                                                 {Kind::kCancelled, "cancelled"},
                                                                 {Kind::kReturned, "returned"}}};

std::string ToText(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<WorkerExit> ReadExit(const fs::path& file) {
  try {
    const Json json = Json::parse(ReadFile(file, kMaxExitBytes));
    for (const auto& [kind, word] : kKinds)
      if (json.at("kind") == word)
        return WorkerExit{kind, json.at("code").get<std::string>(),
                          json.at("sentence").get<std::string>()};
  } catch (const std::exception&) {
    // Not there yet.
  }
  return std::nullopt;
}

/// The names of an attempt's files among those of all its job's workers.
fs::path InWorkerFolder(const fs::path& attempt, const std::string& rest) {
  return WorkerFolder(attempt) / (attempt.filename().string() + rest);
}

}  // namespace

void WriteNodeOrder(const fs::path& attempt, const NodeOrder& order) {
  // A path that is not UTF-8 would come out as another one: dump throws.
  const Json json = {
      {"command", order.command},
      {"preparations", order.preparations},
      {"seconds", order.limits.time.count()},
      {"memory_bytes", order.limits.memory_bytes},
      {"hang_ms", order.limits.hang.count()},
      {"silence_ms", order.limits.silence.count()},
      {"data", order.data.string()},
      {"visible", std::vector<std::string>(order.visible.begin(), order.visible.end())}};
  fs::create_directories(attempt / "runs");
  WriteFileAtomically(attempt / "runs" / "order.json", json.dump() + "\n");
}

NodeOrder ReadNodeOrder(const fs::path& attempt) {
  const std::string text = ReadFile(attempt / "runs" / "order.json");
  try {
    const Json json = Json::parse(text);
    NodeOrder order;
    order.command = json.at("command").get<std::vector<std::string>>();
    order.preparations = json.value("preparations", order.preparations);
    order.limits.time = std::chrono::seconds(json.at("seconds").get<std::int64_t>());
    order.limits.memory_bytes = json.at("memory_bytes").get<std::int64_t>();
    order.limits.hang = std::chrono::milliseconds(json.at("hang_ms").get<std::int64_t>());
    order.limits.silence = std::chrono::milliseconds(json.at("silence_ms").get<std::int64_t>());
    order.data = json.at("data").get<std::string>();
    for (const auto& path : json.at("visible")) order.visible.emplace_back(path.get<std::string>());
    return order;
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInternal, "the order of the attempt is damaged");
  }
}

void WriteNodeScript(const fs::path& attempt) { WriteFileAtomically(NodeScript(attempt), kScript); }

fs::path NodeScript(const fs::path& attempt) { return attempt / "runs" / "run.sh"; }

fs::path WorkerFolder(const fs::path& attempt) {
  return attempt.parent_path() / DataDirectory::kWorkerFolder;
}

fs::path RunFolder(const fs::path& attempt, const std::string& slurm_id, int restarts) {
  return InWorkerFolder(attempt, "-" + slurm_id + "-" + std::to_string(restarts));
}

fs::path PreparationProgress(const fs::path& attempt, int number) {
  return InWorkerFolder(attempt, kPreparation + std::to_string(number) + ".ndjson");
}

fs::path PreparationLog(const fs::path& attempt, int number) {
  return attempt / "runs" / ("prepare-" + std::to_string(number) + ".txt");
}

fs::path PreparationFolder(const fs::path& attempt, int number, const std::string& slurm_id,
                           int restarts) {
  return InWorkerFolder(attempt, kPreparation + std::to_string(number) + "-" + slurm_id + "-" +
                                     std::to_string(restarts));
}

void WriteNodeExit(const fs::path& attempt, const fs::path& run, const WorkerExit& exit) {
  for (const auto& [kind, word] : kKinds)
    if (kind == exit.kind)
      WriteFileAtomically(
          attempt / "runs" / (run.filename().string() + std::string(kExit)),
          ToText({{"kind", word}, {"code", exit.code}, {"sentence", exit.sentence}}));
}

std::optional<NodeExit> FindNodeExit(const fs::path& attempt) {
  std::error_code error;
  for (fs::directory_iterator entry(attempt / "runs", error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    if (!name.ends_with(kExit)) continue;
    const fs::path run = WorkerFolder(attempt) / name.substr(0, name.size() - kExit.size());
    if (const auto exit = ReadExit(entry->path())) return NodeExit{run, *exit};
  }
  return std::nullopt;
}

}  // namespace parkade
