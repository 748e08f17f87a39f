#include "server/store/uploads/resumable_uploads.h"

#include "core/error.h"
#include "core/log.h"
#include "server/store/access/audit_log.h"
#include "server/store/access/tokens.h"
#include "server/store/disk/durable_file.h"
#include "server/store/disk/growing_file.h"
#include "server/store/tables/names.h"
#include "server/store/uploads/part_digest.h"
#include "server/store/uploads/whole_upload.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kSyncBytes = std::int64_t{32} << 20;  // a kill costs at most these
constexpr auto kLockPatience = 10s;                          // a busy disk may take its time
constexpr auto kTidyInterval = 10min;

}  // namespace

ResumableUploads::ResumableUploads(Store& store, UploadOptions options)
    : store_(store),
      options_(std::move(options)),
      sets_(store_, options_, locks_),
      thread_([this] { Work(); }) {}

ResumableUploads::~ResumableUploads() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  stopping_.notify_all();
  thread_.join();
}

void ResumableUploads::Stop() {
  is_stopping_ = true;
  sets_.Stop();
}

std::filesystem::path ResumableUploads::FileOf(const Upload& upload) const {
  return store_.directory.UploadFile(upload.set.value_or(upload.id));
}

UploadLocks::Hold ResumableUploads::Take(const std::string& id, std::function<void()> give_up) {
  auto hold = locks_.Take(id, std::move(give_up), kLockPatience);
  Require(hold.has_value(), ErrorCode::kConflict,
          "another request still adds to upload '" + id + "': try again in a moment");
  return std::move(*hold);
}

Upload ResumableUploads::Look(const std::string& id) {
  return store_.database.Read([&](Connection& connection) { return FindUpload(connection, id); });
}

std::string ResumableUploads::ExpiryFromNow() const {
  return UtcText(std::chrono::system_clock::now() + options_.lifetime);
}

Upload ResumableUploads::Create(Upload upload) {
  Require(upload.length > 0, ErrorCode::kInvalidInput, "the upload is empty");
  CheckNewDrive(store_, {upload.filename, upload.site, upload.rig});
  RequireSpace(store_, upload.length);
  upload.id = NewId();
  upload.created_at = NowUtc();
  upload.created_by = IdOfCurrentCaller();
  upload.expires_at = ExpiryFromNow();
  const std::filesystem::path file = FileOf(upload);
  try {
    GrowingFile::Create(file, upload.length).Sync();
    SyncToDisk(file.parent_path());
    store_.database.Write([&](Connection& connection) {
      InsertUpload(connection, upload);
      RecordAudit(connection, "upload.create", upload.id);
    });
  } catch (const DiskFailure&) {
    throw;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    throw;
  }
  const std::lock_guard lock(mutex_);
  hashes_[upload.id] = std::make_shared<ArrivedHash>();
  return upload;
}

Upload ResumableUploads::Find(const std::string& id) {
  Look(id);  // an id that does not exist needs no lock
  const UploadLocks::Hold hold = Take(id, [] {});
  return Look(id);
}

Upload ResumableUploads::Append(const std::string& id, std::int64_t offset, std::int64_t bytes,
                                const Part& part, const std::optional<PartChecksum>& checksum,
                                const std::function<void()>& give_up) {
  Look(id);
  const UploadLocks::Hold hold = Take(id, give_up);
  Upload upload = Look(id);
  Require(upload.state != UploadState::kRefused, ErrorCode::kInvalidInput,
          upload.error.value_or("the upload was refused"));
  Require(offset == upload.offset, ErrorCode::kConflict,
          "the upload goes on at byte " + std::to_string(upload.offset) + ", not at byte " +
              std::to_string(offset));
  Require(bytes <= upload.length - offset, ErrorCode::kInvalidInput,
          "the part is longer than what is missing of the upload");
  if (upload.state == UploadState::kDone) return upload;
  // It is whole, and what was to follow failed: on a full disk, say.
  if (offset == upload.length) return Finish(upload);

  const std::int64_t first = upload.first_byte;
  GrowingFile file = upload.set ? GrowingFile::WriteOver(FileOf(upload), first + offset)
                                : GrowingFile::Continue(FileOf(upload), offset);
  const std::shared_ptr<ArrivedHash> hash = HashOf(upload);
  // Bytes that a checksum may take back are hashed once they stay.
  const bool is_hashed = !checksum && hash->bytes() == offset && (!upload.set || upload.sha256);
  std::optional<PartDigest> digest;
  if (checksum) digest.emplace(checksum->algorithm);
  const auto keep = [&] {
    file.Sync();
    upload.offset = file.size() - first;
    upload.expires_at = ExpiryFromNow();
    store_.database.Write([&](Connection& connection) {
      SetUploadOffset(connection, id, upload.offset, upload.expires_at);
    });
  };
  const bool is_whole = part([&](std::string_view piece) {
    file.Append(piece);
    if (is_hashed) hash->Add(piece);
    if (digest) digest->Add(piece);
    if (!digest && file.size() - first - upload.offset >= kSyncBytes) keep();
  });
  const bool is_complete = is_whole && file.size() - first == offset + bytes;
  if (digest && is_complete && digest->Finish() != checksum->digest) throw ChecksumMismatch();
  if (!digest || is_complete) keep();
  // Clients of tus try again after a conflict.
  Require(is_complete, ErrorCode::kConflict, "the part broke off: ask how far it came");
  return upload.offset == upload.length ? Finish(upload) : upload;
}

std::string ResumableUploads::HashOfWhole(const Upload& upload) {
  const std::shared_ptr<ArrivedHash> hash = HashOf(upload);
  Require(hash->CatchUp(FileOf(upload), upload.length, is_stopping_), ErrorCode::kInternal,
          "the service stops: it finishes the upload when it starts again");
  return hash->Finish();
}

Upload ResumableUploads::FinishPart(const Upload& upload) {
  const std::string sha256 = upload.sha256 ? HashOfWhole(upload) : "";
  ForgetHash(upload.id);
  const bool is_sound = !upload.sha256 || *upload.sha256 == sha256;
  store_.database.Write([&](Connection& connection) {
    if (is_sound) {
      SetUploadWhole(connection, upload.id);
    } else {
      SetUploadOffset(connection, upload.id, 0, ExpiryFromNow());
    }
  });
  if (!is_sound)
    throw ChecksumMismatch("'" + *upload.path + "' arrived with the SHA-256 " + sha256 +
                           ", not the one that was announced: send it again");
  sets_.Wake();
  return Look(upload.id);
}

/// Makes a drive of an upload that is there as a whole, or tells its set. The caller holds it.
Upload ResumableUploads::Finish(const Upload& upload) {
  if (upload.set) return FinishPart(upload);
  const std::filesystem::path file = FileOf(upload);
  const std::string sha256 = HashOfWhole(upload);
  ForgetHash(upload.id);
  try {
    Require(!upload.sha256 || *upload.sha256 == sha256, ErrorCode::kInvalidInput,
            "the log that arrived has the SHA-256 " + sha256 + ", not the one that was announced");
    options_.check_log(file, upload.filename);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kInvalidInput) throw;
    Refuse(upload, "invalid_input", error.what());
    throw;
  }
  MakeDriveOf(
      {file, upload.length, sha256}, store_, {upload.filename, upload.site, upload.rig}, options_,
      [&](Connection& connection, const Drive& drive) {
        SetUploadDone(connection, upload.id, drive.id);
      },
      "upload=" + upload.id);
  return Look(upload.id);
}

void ResumableUploads::Refuse(const Upload& upload, const std::string& code,
                              const std::string& sentence) {
  WriteToMakeRoom(store_, [&](Connection& connection) {
    SetUploadRefused(connection, upload.id, code, sentence);
  });
  std::error_code ignored;
  std::filesystem::remove(FileOf(upload), ignored);
}

void ResumableUploads::Terminate(const std::string& id) {
  const std::optional<std::string> set = Look(id).set;
  Require(!set, ErrorCode::kConflict,
          "the upload is a part of a set: DELETE /api/v1/upload-sets/" + set.value_or(""));
  const UploadLocks::Hold hold = Take(id, [] {});
  Look(id);
  Remove(id);
}

void ResumableUploads::Remove(const std::string& id) {
  WriteToMakeRoom(store_, [&](Connection& connection) {
    DeleteUpload(connection, id);
    RecordAudit(connection, "upload.delete", id);
  });
  ForgetHash(id);
  std::error_code ignored;
  std::filesystem::remove(store_.directory.UploadFile(id), ignored);
}

std::shared_ptr<ArrivedHash> ResumableUploads::HashOf(const Upload& upload) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<ArrivedHash>& hash = hashes_[upload.id];
  // A part that failed may have left it ahead of what was kept.
  if (!hash || hash->bytes() > upload.offset)
    hash = std::make_shared<ArrivedHash>(upload.first_byte);
  return hash;
}

void ResumableUploads::ForgetHash(const std::string& id) {
  const std::lock_guard lock(mutex_);
  hashes_.erase(id);
}

/// Those of parts whose set is gone.
void ResumableUploads::ForgetHashesOfRemoved() {
  const std::lock_guard lock(mutex_);
  store_.database.Read([&](Connection& connection) {
    std::erase_if(hashes_, [&](const auto& entry) { return !HasUpload(connection, entry.first); });
  });
}

void ResumableUploads::Work() {
  try {
    std::unique_lock lock(mutex_);
    while (!is_stopping_) {
      lock.unlock();
      try {
        EndWhatIsOver();
        RemoveExpired();
      } catch (const DiskFailure&) {
        throw;
      } catch (const Error& error) {  // a full disk
        LogWarning(std::string("uploads wait error=") + error.what());
      }
      lock.lock();
      stopping_.wait_for(lock, kTidyInterval, [this] { return is_stopping_.load(); });
    }
  } catch (const DiskFailure& failure) {
    store_.database.Freeze(failure.what());
  } catch (const std::exception& error) {
    LogError(std::string("uploads are not tidied up any more error=") + error.what());
  }
}

/// Whether nothing more can arrive of it.
bool ResumableUploads::IsOver(const Upload& upload) const {
  return upload.state == UploadState::kReceiving &&
         (upload.offset == upload.length || IsLost(upload));
}

bool ResumableUploads::IsLost(const Upload& upload) const {
  if (upload.set) return false;  // sets look after their file
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(FileOf(upload), missing);
  return missing || static_cast<std::int64_t>(bytes) < upload.offset;
}

/// Finishes what is whole, and refuses what the disk lost.
void ResumableUploads::EndWhatIsOver() {
  for (const Upload& found : store_.database.Read(UnfinishedUploads)) {
    if (is_stopping_) return;
    if (!IsOver(found)) continue;
    try {
      const UploadLocks::Hold hold = Take(found.id, [] {});
      const Upload upload = Look(found.id);
      if (!IsOver(upload)) continue;
      const Caller maker = store_.database.Read(
          [&](Connection& connection) { return MakerOf(connection, upload.created_by); });
      const WorkFor scope(maker);
      if (IsLost(upload))
        Refuse(upload, "internal", "the disk lost what had arrived: upload the log anew");
      else
        Finish(upload);
    } catch (const DiskFailure&) {
      throw;
    } catch (const Error& error) {
      LogWarning("upload id=" + found.id + " not finished error=" + error.what());
    }
  }
}

void ResumableUploads::RemoveExpired() {
  const std::string now = NowUtc();
  const auto expired =
      store_.database.Read([&](Connection& connection) { return ExpiredUploads(connection, now); });
  for (const std::string& id : expired) {
    const auto hold = locks_.Take(
        id, [] {}, 0ms);
    // A part may have come until just now, or somebody ended it.
    const bool is_expired = hold && store_.database.Read([&](Connection& connection) {
      return HasUpload(connection, id) && FindUpload(connection, id).expires_at < now;
    });
    if (!is_expired) continue;
    Remove(id);
    LogInfo("upload expired id=" + id);
  }
  ForgetHashesOfRemoved();
}

}  // namespace parkade
