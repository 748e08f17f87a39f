#pragma once

#include "server/jobs/job_spec.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// The folders of one attempt at a job. The service's, where its worker only reads:
///
///   attempt-<n>/input/<drive name>   the logs, as links into the store
///   attempt-<n>/log.txt              what the worker prints; kept
///   attempt-<n>/runs/                where an engine keeps its orders and what became of them
///   attempt-<n>/out/                 the products once the worker has ended; become the map
///
/// and those of its workers, all in one folder of the job, so that links lead from one to the
/// other:
///
///   worker/attempt-<n>/              its working directory
///     out/                           what it makes
///     progress.ndjson                what it says about itself
///     tmp/                           its temporary files
///   worker/attempt-<n>.preview.glb   what the map will look like, once it knows; see EncodePreview
///   worker/work/                     what the attempts of a job found (server/store/job_work.h)
///
/// All but log.txt and work/ is gone when this object is, unless it is kept.
class AttemptFolder {
 public:
  /// Throws Error{kInvalidInput} for a job whose drives were all deleted, Error{kNotFound} when a
  /// drive or its rig is not there any more, Error{kDiskFull}. Begins with empty folders, unless an
  /// engine has the job still (its `place`).
  AttemptFolder(Store& store, const Job& job);
  ~AttemptFolder();
  AttemptFolder(const AttemptFolder&) = delete;
  AttemptFolder& operator=(const AttemptFolder&) = delete;

  /// Leaves everything where it is, for a worker that goes on.
  void Keep() { is_kept_ = true; }

  /// False where an earlier service took them for a map and ended before it was one.
  bool HasProducts(const std::filesystem::path& products) const;

  /// Takes the products of a worker that has ended out of its folder, to where no worker gets.
  /// Returns where they are. Throws Error{kInternal} where it left none.
  std::filesystem::path TakeProducts(const std::filesystem::path& products) const;

  const JobSpec& spec() const { return spec_; }
  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& data() const { return data_; }  ///< the data directory
  /// The one folder that the worker may write in.
  std::filesystem::path WorkerFolder() const { return spec_.work.parent_path(); }
  /// A worker of this machine runs here.
  std::filesystem::path RunFolder() const { return WorkerFolder() / path_.filename(); }
  std::filesystem::path LogFile() const { return path_ / kLogName; }
  std::filesystem::path TemporaryFiles() const { return RunFolder() / "tmp"; }

  static constexpr const char* kLogName = "log.txt";

 private:
  void Begin(const Job& job);

  const Store& store_;
  std::filesystem::path data_, path_;
  JobSpec spec_;
  bool is_kept_ = false;
};

}  // namespace parkade
