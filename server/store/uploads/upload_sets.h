#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/store/tables/upload_set_table.h"
#include "server/store/tables/upload_table.h"
#include "server/store/uploads/upload_locks.h"
#include "server/store/uploads/upload_options.h"
#include "server/store/uploads/upload_part.h"

namespace parkade {

/// Drives in several files, each an upload that is added to as any other (ResumableUploads).
///
/// The log that becomes of a set is an uncompressed tar of its files in order of their paths, the
/// same for equal files; a single file becomes just that log. Since paths and sizes are known
/// beforehand, so is where each byte of the tar lies: parts are written there at once, and the tar
/// is there with the last of them, without room or time for a copy. What is left to do then, in a
/// thread of its own, is its hash. Thread-safe.
class UploadSets {
 public:
  /// Borrows the store, and the locks of the uploads. In its thread it also takes up what an
  /// earlier service had whole, and removes what has expired.
  UploadSets(Store& store, const UploadOptions& options, UploadLocks& locks);
  ~UploadSets();
  UploadSets(const UploadSets&) = delete;
  UploadSets& operator=(const UploadSets&) = delete;

  struct SetWithParts {
    UploadSet set;
    std::vector<Upload> parts;  ///< in order of their paths
  };

  /// Makes room for all parts of `set`, whose name, site and rig count, and an upload for each.
  /// Throws Error{kInvalidInput} where they would not make a log, Error{kDiskFull}, before a byte
  /// is taken.
  SetWithParts Create(UploadSet set, std::vector<UploadPart> parts);

  /// The set as far as it is known, disturbing nobody. Throws Error{kNotFound}.
  SetWithParts Look(const std::string& id);

  /// Forgets a set and its uploads; a drive that was made of it stays. Throws Error{kNotFound},
  /// Error{kConflict} while it is put together or whoever adds to a part does not stop.
  void Terminate(const std::string& id);

  /// A part has come as a whole.
  void Wake();
  /// Breaks off what takes long and can be done by the next service.
  void Stop() { is_stopping_ = true; }

 private:
  bool Remove(const std::string& id, std::chrono::milliseconds patience,
              const std::string& expired_at = "");
  void Refuse(const std::string& id, const std::string& code, const std::string& sentence);
  void Finish(const UploadSet& set);
  void AssembleWhole();
  void Assemble(const std::string& id);
  void RefuseLost();
  void RemoveExpired();
  void Work();

  Store& store_;
  const UploadOptions& options_;
  UploadLocks& locks_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool has_whole_part_ = false;
  std::atomic<bool> is_stopping_ = false;
  std::thread thread_;
};

}  // namespace parkade
