#include "server/store/uploads/upload_sets.h"

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "server/store/access/audit_log.h"
#include "server/store/access/tokens.h"
#include "server/store/disk/durable_file.h"
#include "server/store/disk/growing_file.h"
#include "server/store/tables/names.h"
#include "server/store/uploads/arrived_hash.h"
#include "server/store/uploads/tar_frame.h"
#include "server/store/uploads/whole_upload.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr auto kPartPatience = 10s;  // a busy disk may take its time
constexpr auto kSetInterval = 10min;

TarFrame FrameOf(const std::vector<UploadPart>& parts) {
  std::vector<TarFrame::File> files;
  files.reserve(parts.size());
  for (const UploadPart& part : parts) files.push_back({part.path, part.bytes});
  return TarFrame(files);
}

std::vector<std::string> PathsOf(const std::vector<UploadPart>& parts) {
  std::vector<std::string> paths;
  paths.reserve(parts.size());
  for (const UploadPart& part : parts) paths.push_back(part.path);
  return paths;
}

Upload UploadOf(const UploadSet& set, const UploadPart& part, std::int64_t first_byte) {
  Upload upload;
  upload.id = NewId();
  upload.filename = part.path;
  upload.site = set.site;
  upload.rig = set.rig;
  upload.sha256 = part.sha256;
  upload.length = part.bytes;
  upload.created_at = set.created_at;
  upload.expires_at = set.expires_at;
  upload.created_by = set.created_by;
  upload.set = set.id;
  upload.path = part.path;
  upload.first_byte = first_byte;
  return upload;
}

UploadSets::SetWithParts Found(Connection& connection, const std::string& id) {
  return {FindUploadSet(connection, id), UploadsOfSet(connection, id)};
}

}  // namespace

UploadSets::UploadSets(Store& store, const UploadOptions& options, UploadLocks& locks)
    : store_(store), options_(options), locks_(locks), thread_([this] { Work(); }) {}

UploadSets::~UploadSets() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

UploadSets::SetWithParts UploadSets::Create(UploadSet set, std::vector<UploadPart> parts) {
  std::sort(parts.begin(), parts.end(),
            [](const UploadPart& a, const UploadPart& b) { return a.path < b.path; });
  CheckParts(parts);
  const bool is_tar = parts.size() > 1;  // a single file is a log by itself
  if (is_tar && options_.check_paths) options_.check_paths(PathsOf(parts));
  CheckNewDrive(store_, {set.filename, set.site, set.rig});
  const TarFrame frame = FrameOf(parts);
  set.id = NewId();
  set.bytes = is_tar ? frame.bytes() : parts.front().bytes;
  set.created_at = NowUtc();
  set.created_by = IdOfCurrentCaller();
  set.expires_at = UtcIn(options_.lifetime);
  RequireSpace(store_, set.bytes);

  const std::filesystem::path path = store_.directory.UploadFile(set.id);
  try {
    GrowingFile file = GrowingFile::Create(path, set.bytes);
    if (is_tar) {
      frame.Write(file);
    } else {
      file.Skip(set.bytes);
    }
    file.Sync();
    SyncToDisk(path.parent_path());
    return store_.database.Write([&](Connection& connection) {
      InsertUploadSet(connection, set);
      for (size_t i = 0; i < parts.size(); ++i)
        InsertUpload(connection, UploadOf(set, parts[i], is_tar ? frame.FirstByteOf(i) : 0));
      RecordAudit(connection, "upload_set.create", set.id);
      return Found(connection, set.id);
    });
  } catch (const DiskFailure&) {
    throw;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw;
  }
}

UploadSets::SetWithParts UploadSets::Look(const std::string& id) {
  return store_.database.Read([&](Connection& connection) { return Found(connection, id); });
}

void UploadSets::Terminate(const std::string& id) {
  Look(id);
  Require(Remove(id, kPartPatience), ErrorCode::kConflict,
          "upload set '" + id + "' is in use: try again in a moment");
}

/// Takes the set and all of its parts from whoever adds to them; false where one does not let go
/// within `patience`, or the set has not expired by `expired_at`, unless that is empty.
bool UploadSets::Remove(const std::string& id, std::chrono::milliseconds patience,
                        const std::string& expired_at) {
  const auto hold = locks_.Take(
      id, [] {}, patience);
  if (!hold) return false;
  const std::vector<Upload> parts =
      store_.database.Read([&](Connection& connection) { return UploadsOfSet(connection, id); });
  if (parts.empty()) return true;  // another one was first
  std::vector<UploadLocks::Hold> holds;
  for (const Upload& part : parts) {
    auto of_part = locks_.Take(
        part.id, [] {}, patience);
    if (!of_part) return false;
    holds.push_back(std::move(*of_part));
  }
  if (!expired_at.empty() && Look(id).set.expires_at >= expired_at) return false;
  WriteToMakeRoom(store_, [&](Connection& connection) {
    DeleteUploadSet(connection, id);
    RecordAudit(connection, "upload_set.delete", id);
  });
  std::error_code ignored;
  std::filesystem::remove(store_.directory.UploadFile(id), ignored);
  return true;
}

void UploadSets::Refuse(const std::string& id, const std::string& code,
                        const std::string& sentence) {
  WriteToMakeRoom(
      store_, [&](Connection& connection) { SetUploadSetRefused(connection, id, code, sentence); });
  std::error_code ignored;
  std::filesystem::remove(store_.directory.UploadFile(id), ignored);
}

void UploadSets::Wake() {
  {
    const std::lock_guard lock(mutex_);
    has_whole_part_ = true;
  }
  changed_.notify_all();
}

/// Makes a drive of a set whose parts are all there. The caller holds it.
void UploadSets::Finish(const UploadSet& set) {
  const std::filesystem::path file = store_.directory.UploadFile(set.id);
  const auto [maker, num_parts] = store_.database.Write([&](Connection& connection) {
    SetUploadSetAssembling(connection, set.id);
    return std::pair(MakerOf(connection, set.created_by), UploadsOfSet(connection, set.id).size());
  });
  ArrivedHash hash;
  if (!hash.CatchUp(file, set.bytes, is_stopping_)) return;
  if (num_parts == 1) options_.check_log(file, set.filename);
  const WorkFor scope(maker);
  MakeDriveOf(
      {file, set.bytes, hash.Finish()}, store_, {set.filename, set.site, set.rig}, options_,
      [&](Connection& connection, const Drive& drive) {
        SetUploadSetDone(connection, set.id, drive.id);
      },
      "upload_set=" + set.id);
}

void UploadSets::Assemble(const std::string& id) {
  const auto hold = locks_.Take(
      id, [] {}, kPartPatience);
  if (!hold) return;  // whoever removes it
  try {
    Finish(Look(id).set);
  } catch (const DiskFailure&) {
    throw;
  } catch (const Error& error) {
    LogWarning("upload set id=" + id + " not finished error=" + error.what());
    if (error.code() == ErrorCode::kInvalidInput) Refuse(id, "invalid_input", error.what());
  }
}

void UploadSets::AssembleWhole() {
  for (const UploadSet& set : store_.database.Read(WholeUploadSets)) {
    if (is_stopping_) return;
    Assemble(set.id);
  }
}

/// Refuses sets whose file went or shrank while no service ran.
void UploadSets::RefuseLost() {
  for (const UploadSet& set : store_.database.Read(UnfinishedUploadSets)) {
    std::error_code missing;
    const auto bytes = std::filesystem::file_size(store_.directory.UploadFile(set.id), missing);
    if (missing || static_cast<std::int64_t>(bytes) != set.bytes)
      Refuse(set.id, "internal", "the disk lost what had arrived: upload the log anew");
  }
}

void UploadSets::RemoveExpired() {
  const std::string now = NowUtc();
  const auto expired = store_.database.Read(
      [&](Connection& connection) { return ExpiredUploadSets(connection, now); });
  for (const std::string& id : expired)
    if (Remove(id, 0ms, now)) LogInfo("upload set expired id=" + id);
}

void UploadSets::Work() {
  try {
    bool has_looked = false;
    std::unique_lock lock(mutex_);
    while (!is_stopping_) {
      has_whole_part_ = false;
      lock.unlock();
      try {
        if (!has_looked) RefuseLost();
        has_looked = true;
        AssembleWhole();
        RemoveExpired();
      } catch (const DiskFailure&) {
        throw;
      } catch (const Error& error) {  // a full disk
        LogWarning(std::string("upload sets wait error=") + error.what());
      }
      lock.lock();
      changed_.wait_for(lock, kSetInterval,
                        [this] { return is_stopping_.load() || has_whole_part_; });
    }
  } catch (const DiskFailure& failure) {
    store_.database.Freeze(failure.what());
  } catch (const std::exception& error) {
    LogError(std::string("upload sets are not put together any more error=") + error.what());
  }
}

}  // namespace parkade
