#include "server/store/care/retention.h"

#include <optional>

#include "core/error.h"
#include "core/log.h"
#include "server/store/access/audit_log.h"
#include "server/store/job_work.h"
#include "server/store/receive_upload.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;
using TimePoint = std::chrono::system_clock::time_point;

struct Lifetime {
  std::string site;
  std::optional<std::int64_t> log_days, map_days;
};

std::vector<Lifetime> Lifetimes(Connection& connection) {
  Statement query = connection.Query(
      "SELECT name, log_days, map_days FROM sites WHERE log_days IS NOT NULL OR map_days IS NOT "
      "NULL ORDER BY name");
  std::vector<Lifetime> lifetimes;
  while (query.Step()) {
    const auto days = [&](int column) {
      return query.IsNull(column) ? std::nullopt : std::optional(query.Integer(column));
    };
    lifetimes.push_back({query.Text(0), days(1), days(2)});
  }
  return lifetimes;
}

// Drives of the site ?1 whose logs came before ?2 and that no job that waits or runs needs.
const std::string kExpiredLogs = R"(
  SELECT id FROM drives
  WHERE site = ?1 AND created_at < ?2 AND deleted_at IS NULL AND log_deleted_at IS NULL
    AND NOT EXISTS (SELECT 1 FROM job_drives JOIN jobs ON jobs.id = job_drives.job
                      WHERE job_drives.drive = drives.id AND jobs.state IN ('queued', 'running')))";

// Versions of the site ?1 that were made before ?2 and may go.
const std::string kExpiredMaps = R"(
  SELECT id FROM maps
  WHERE site = ?1 AND created_at < ?2 AND files_deleted_at IS NULL AND review_state != 'approved'
    AND version < (SELECT max(version) FROM maps WHERE site = ?1)
    AND NOT EXISTS (SELECT 1 FROM jobs
                      WHERE jobs.site = ?1
                        AND (jobs.state = 'running'
                             OR (jobs.state = 'queued'
                                 AND json_extract(jobs.review, '$.from') = maps.version))))";

std::vector<std::string> Find(Store& store, const std::string& select, const std::string& site,
                              const std::string& limit) {
  return store.database.Read([&](Connection& connection) {
    return Texts(connection.Query(select + " ORDER BY sequence", site, limit));
  });
}

/// Asked again inside the transaction: a job may need it by now.
bool IsAmong(Connection& connection, const std::string& select, const std::string& site,
             const std::string& limit, const std::string& id) {
  return connection.Query(select + " AND id = ?3", site, limit, id).Step();
}

std::string Before(TimePoint now, std::int64_t days) {
  return UtcText(now - std::chrono::days(days));
}

/// The file goes after the commit: the other way round, a failed commit would leave a drive
/// without its log. What a crash leaves between the two goes at the next start.
bool DeleteLog(Store& store, const std::string& site, const std::string& id, TimePoint now,
               const std::string& limit) {
  const auto sha256 =
      WriteToMakeRoom(store, [&](Connection& connection) -> std::optional<std::string> {
        if (!IsAmong(connection, kExpiredLogs, site, limit, id)) return std::nullopt;
        const Drive drive = FindDrive(connection, id);
        MarkLogDeleted(connection, id, UtcText(now));
        RecordAudit(connection, "log.expire", id, "{\"sha256\":\"" + drive.sha256 + "\"}");
        if (CountDrivesWithContent(connection, drive.sha256) == 0)
          DropFileCheck(connection, DataDirectory::LogPath(drive.sha256));
        return drive.sha256;
      });
  if (!sha256) return false;
  RemoveUnusedLog(store, *sha256);
  DropWorkOfDrive(store, id);
  LogInfo("retention deleted log drive=" + id + " site=" + site + " sha256=" + *sha256);
  return true;
}

/// Comparisons are kept in a folder named after both versions.
void RemoveComparisons(const Store& store, const std::string& map) {
  std::error_code ignored;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(store.directory.root() / "tmp", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("compare-") && name.find(map) != std::string::npos)
      fs::remove_all(entry.path(), ignored);
  }
}

std::optional<std::int64_t> DeleteMap(Store& store, const std::string& site, const std::string& id,
                                      TimePoint now, const std::string& limit) {
  const auto version =
      WriteToMakeRoom(store, [&](Connection& connection) -> std::optional<std::int64_t> {
        if (!IsAmong(connection, kExpiredMaps, site, limit, id)) return std::nullopt;
        MarkFilesDeleted(connection, id, UtcText(now));
        connection.Execute("DELETE FROM file_checks WHERE path >= ? AND path < ?",
                           "maps/" + id + "/", "maps/" + id + "0");
        Statement query = connection.Query("SELECT version FROM maps WHERE id = ?", id);
        query.Step();
        const std::int64_t number = query.Integer(0);
        RecordAudit(connection, "map.expire", site + "/" + std::to_string(number));
        return number;
      });
  if (!version) return std::nullopt;
  fs::remove_all(store.directory.MapFolder(id));
  RemoveComparisons(store, id);
  LogInfo("retention deleted map site=" + site + " version=" + std::to_string(*version) +
          " id=" + id);
  return version;
}

void DeleteOfSite(Store& store, const Lifetime& lifetime, TimePoint now, Expired& expired) {
  if (lifetime.log_days) {
    const std::string limit = Before(now, *lifetime.log_days);
    for (const std::string& id : Find(store, kExpiredLogs, lifetime.site, limit))
      if (DeleteLog(store, lifetime.site, id, now, limit)) expired.drives.push_back(id);
  }
  if (lifetime.map_days) {
    const std::string limit = Before(now, *lifetime.map_days);
    for (const std::string& id : Find(store, kExpiredMaps, lifetime.site, limit))
      if (const auto version = DeleteMap(store, lifetime.site, id, now, limit))
        expired.maps.emplace_back(lifetime.site, *version);
  }
}

}  // namespace

Expired DeleteExpired(Store& store, TimePoint now) {
  Expired expired;
  for (const Lifetime& lifetime : store.database.Read(Lifetimes))
    DeleteOfSite(store, lifetime, now, expired);
  DropStaleWork(store, now);
  if (!expired.drives.empty() || !expired.maps.empty()) store.ballast.Restore();
  return expired;
}

RetentionKeeper::RetentionKeeper(Store& store, std::chrono::milliseconds interval,
                                 Listener listener, Clock clock)
    : store_(store),
      listener_(std::move(listener)),
      clock_(std::move(clock)),
      thread_([this, interval] { Work(interval); }) {}

RetentionKeeper::~RetentionKeeper() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  stopping_.notify_all();
  thread_.join();
}

void RetentionKeeper::Work(std::chrono::milliseconds interval) {
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    lock.unlock();
    try {
      listener_(DeleteExpired(store_, clock_()));
    } catch (const DiskFailure& failure) {
      store_.database.Freeze(failure.what());
      return;
    } catch (const std::exception& error) {
      LogError(std::string("retention error=") + error.what());  // tried again next time
    }
    lock.lock();
    stopping_.wait_for(lock, interval, [this] { return is_stopping_; });
  }
}

}  // namespace parkade
