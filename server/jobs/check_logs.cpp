#include "server/jobs/check_logs.h"

#include "core/error.h"
#include "server/store/care/stored_files.h"
#include "server/store/tables/drive_table.h"

namespace parkade {

void CheckLogs(Store& store, const Job& job, const std::function<bool()>& go_on) {
  for (const std::string& id : job.drives) {
    const Drive drive =
        store.database.Read([&](Connection& connection) { return FindDrive(connection, id); });
    const StoredFile log{DataDirectory::LogPath(drive.sha256), drive.bytes, drive.sha256};
    const auto damage = CheckStoredFile(store.directory.root(), log, go_on);
    if (!damage) continue;
    RecordFileCheck(store, log.path, damage);
    throw Error(ErrorCode::kInternal,
                "the stored log of drive '" + drive.name + "' " + *damage + ": upload it again");
  }
}

}  // namespace parkade
