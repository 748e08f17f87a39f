#pragma once

#include "server/jobs/job_spec.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// The folder of one attempt at a job:
///
///   input/<drive name>   the logs, as links into the store
///   out/                 what the worker makes; becomes the map
///   progress.ndjson      what the worker says about itself
///   preview.glb          what the map will look like, once the worker knows; see EncodePreview
///   log.txt              what the worker prints; kept
///   tmp/                 the worker's temporary files
///   runs/                where an engine may start the worker more than once: its own folders
///
/// input/, out/, tmp/, runs/ and preview.glb are gone when this object is, unless they are kept.
/// What the attempts of a job found lies beside them and stays (server/store/job_work.h).
class AttemptFolder {
 public:
  /// Throws Error{kInvalidInput} for a job whose drives were all deleted, Error{kNotFound} when a
  /// drive or its rig is not there any more, Error{kDiskFull}. What an earlier service has made of
  /// the folder stays as it is.
  AttemptFolder(Store& store, const Job& job);
  ~AttemptFolder();
  AttemptFolder(const AttemptFolder&) = delete;
  AttemptFolder& operator=(const AttemptFolder&) = delete;

  /// Leaves everything where it is, for a worker that goes on.
  void Keep() { is_kept_ = true; }

  const JobSpec& spec() const { return spec_; }
  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& data() const { return data_; }  ///< the data directory
  std::filesystem::path LogFile() const { return path_ / kLogName; }
  std::filesystem::path TemporaryFiles() const { return path_ / "tmp"; }

  static constexpr const char* kLogName = "log.txt";
  static constexpr const char* kPreviewName = "preview.glb";

 private:
  std::filesystem::path data_, path_;
  JobSpec spec_;
  bool is_kept_ = false;
};

}  // namespace parkade
