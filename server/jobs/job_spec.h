#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// One attempt at a map, as a worker process is told of it.
struct JobSpec {
  std::string job;  ///< its id, for messages only
  int attempt = 1;  ///< counts from 1
  std::vector<std::filesystem::path>
      logs;  ///< drive logs; the file name is the drive's name in the map
  std::vector<std::filesystem::path>
      rigs;  ///< per log: folder with the rig files; empty: what the log says
  std::optional<std::filesystem::path>
      from;  ///< finished map whose odometry is taken instead of tracking again
  std::vector<std::string> rejected_loops, forced_loops;  ///< [DRIVE:]LOOP
  std::vector<std::string> rejected_links, forced_links;  ///< DRIVE:KEYFRAME~DRIVE:KEYFRAME
  std::optional<std::vector<std::string>>
      pins;                    ///< in the form of --pin; nothing: those of `from`; empty: none
  std::filesystem::path out;   ///< empty folder for the products
  std::filesystem::path work;  ///< folder for results of stages that outlives the attempt
  int prepared = 0;  ///< number in `logs`, from 1, of the drive that is only to be prepared in
                     ///< `work`; 0: a map is to be made
  std::filesystem::path progress;  ///< file to append progress lines to
  int num_threads = 0;             ///< the worker may use; 0: as many as the machine has cores
  std::filesystem::path preview;   ///< file for what the map will look like, where `from` allows;
                                   ///< written before the map
};

/// What a worker only reads of the data directory: the rest of its job's folder is its own.
inline std::vector<std::filesystem::path> InputsOf(const JobSpec& spec) {
  std::vector<std::filesystem::path> inputs;
  if (!spec.logs.empty()) inputs.push_back(spec.logs.front().parent_path());
  for (const std::filesystem::path& rig : spec.rigs)
    if (!rig.empty()) inputs.push_back(rig);
  if (spec.from) inputs.push_back(*spec.from);
  return inputs;
}

/// How a worker ends, one status per class, so that the class is known even where a full disk took
/// no last words.
enum class WorkerStatus : int {
  kDone = 0,
  kInvalidInput = 1,
  kUsage = 2,
  kInternal = 3,
  kDiskFull = 4,
  kOutOfMemory = 5,
};

/// The command line of the worker for an attempt, the program first.
///
/// The worker appends lines of JSON to `progress`:
///   {"stage": "track", "progress": 0.42, "eta": 30}  of the whole, 0 to 1; [s] left, where known
///   {"error": "sentence", "code": "invalid_input"}   the last line when it fails
/// and ends with a WorkerStatus. On SIGTERM it ends soon. What it prints is kept as the job's log.
using JobCommand = std::function<std::vector<std::string>(const JobSpec&)>;

}  // namespace parkade
