#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/worker_process.h"
#include "server/store/temporary_path.h"

namespace parkade {

/// The command line that hands out pictures of a log, with the folder of its rig if any. It makes
/// the file `index` where there is none, and talks over its standard input, a socket, one JSON
/// object a line each way. It begins with {"ready": true}. Then requests and answers:
///   {"camera", "time" [ns], "width" [px], "out"}     {}, and the file `out`: a line of JSON
///                                                    {"width", "height", "full_width",
///                                                    "full_height"} [px], then a JPEG
///   {"map", "drive", "point" [m], "limit"}           {"views": [{"camera", "time", "pixel", ...}]}
/// An answer may be {"error": SENTENCE, "code": WORD} instead.
using PictureCommand = std::function<std::vector<std::string>(
    const std::filesystem::path& log, const std::optional<std::filesystem::path>& rig,
    const std::filesystem::path& index)>;

/// One process that keeps one log open, so that a picture costs no start of a program. Use from one
/// thread.
class PictureWorker {
 public:
  /// Waits until it is ready, which may take a pass over the log. `place.folder` is made, for its
  /// log and temporary files. Throws Error as Ask.
  PictureWorker(const std::vector<std::string>& command, WorkerPlace place,
                std::chrono::seconds answer_limit, const std::atomic<bool>& is_stopping);
  ~PictureWorker();
  PictureWorker(const PictureWorker&) = delete;
  PictureWorker& operator=(const PictureWorker&) = delete;

  /// Throws Error{kInvalidInput} (kDiskFull) with the worker's sentence, and Error{kInternal} where
  /// it is no more of use: see is_alive().
  nlohmann::json Ask(const nlohmann::json& request);

  bool is_alive() const { return is_alive_; }

 private:
  nlohmann::json Hear(std::chrono::seconds patience);

  const TemporaryPath folder_;
  const std::chrono::seconds answer_limit_;
  const std::atomic<bool>& is_stopping_;
  int socket_ = -1;
  std::optional<WorkerProcess> process_;
  std::string heard_;
  bool is_alive_ = true;
};

}  // namespace parkade
