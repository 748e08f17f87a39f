#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "server/store/tables/upload_table.h"
#include "server/store/uploads/arrived_hash.h"
#include "server/store/uploads/upload_locks.h"
#include "server/store/uploads/upload_options.h"
#include "server/store/uploads/upload_sets.h"

namespace parkade {

/// What a client may ask of a part: that it has this hash, or is not taken at all.
struct PartChecksum {
  std::string algorithm;  ///< "sha1" or "sha256"
  std::string digest;     ///< bytes, not digits
};

/// What is thrown when a part does not have the hash that was announced.
class ChecksumMismatch : public Error {
 public:
  explicit ChecksumMismatch(const std::string& sentence = "the part arrived damaged: send it again")
      : Error(ErrorCode::kInvalidInput, sentence) {}
};

/// Logs that arrive in parts, over as many requests, days and restarts as it takes. An offset that
/// anybody was told is durable. What has arrived whole becomes a drive, also when the service was
/// killed in between; one of a set waits for the others. Thread-safe.
class ResumableUploads {
 public:
  /// Borrows the store. In a thread of its own it finishes what an earlier service had received
  /// whole, refuses what has lost bytes meanwhile, and removes what has expired.
  ResumableUploads(Store& store, UploadOptions options);
  ~ResumableUploads();
  ResumableUploads(const ResumableUploads&) = delete;
  ResumableUploads& operator=(const ResumableUploads&) = delete;

  /// Makes room for a log of `upload.length` bytes, and sets id and times. Throws
  /// Error{kInvalidInput, kDiskFull} before a byte is taken.
  Upload Create(Upload upload);

  /// The upload as it is once whoever adds to it has stopped. Throws Error{kNotFound},
  /// Error{kConflict} while it does not.
  Upload Find(const std::string& id);
  /// The upload as far as it is known, disturbing nobody. Throws Error{kNotFound}.
  Upload Look(const std::string& id);

  /// Reads pieces of a part and hands each to the function; returns false when it broke off.
  using Part = std::function<bool(const std::function<void(std::string_view)>&)>;

  /// Adds a part of `bytes` at `offset`, and makes the drive once all is there. A part that broke
  /// off counts as far as it came, unless a checksum goes with it. `give_up` makes the part break
  /// off, when another request wants this upload. Throws as Find does; Error{kConflict} for another
  /// offset than the upload's or where it broke off, Error{kInvalidInput} where it is too long or
  /// the whole is no log, ChecksumMismatch, Error{kDiskFull}, DiskFailure. An upload of a set that
  /// does not have the hash that was announced begins anew.
  Upload Append(const std::string& id, std::int64_t offset, std::int64_t bytes, const Part& part,
                const std::optional<PartChecksum>& checksum, const std::function<void()>& give_up);

  /// Breaks off what takes long and can be done by the next service.
  void Stop();

  /// Forgets an upload; a drive that was made from it stays. Throws as Find does, and
  /// Error{kConflict} for one of a set.
  void Terminate(const std::string& id);

  UploadSets& sets() { return sets_; }

 private:
  std::filesystem::path FileOf(const Upload& upload) const;
  UploadLocks::Hold Take(const std::string& id, std::function<void()> give_up);
  std::string ExpiryFromNow() const;
  std::shared_ptr<ArrivedHash> HashOf(const Upload& upload);
  void ForgetHash(const std::string& id);
  void ForgetHashesOfRemoved();
  Upload Finish(const Upload& upload);
  Upload FinishPart(const Upload& upload);
  std::string HashOfWhole(const Upload& upload);
  void Refuse(const Upload& upload, const std::string& code, const std::string& sentence);
  void Remove(const std::string& id);
  void Work();
  bool IsOver(const Upload& upload) const;
  bool IsLost(const Upload& upload) const;
  void EndWhatIsOver();
  void RemoveExpired();

  Store& store_;
  const UploadOptions options_;
  UploadLocks locks_;
  std::mutex mutex_;
  std::condition_variable stopping_;
  std::atomic<bool> is_stopping_ = false;
  std::map<std::string, std::shared_ptr<ArrivedHash>> hashes_;  ///< of uploads under way
  UploadSets sets_;
  std::thread thread_;
};

}  // namespace parkade
