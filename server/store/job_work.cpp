#include "server/store/job_work.h"

#include <system_error>
#include <vector>

#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

template <typename... Values>
void DropWorkOf(Store& store, const char* jobs, const Values&... values) {
  const auto ids = store.database.Read(
      [&](Connection& connection) { return Texts(connection.Query(jobs, values...)); });
  for (const std::string& id : ids) DropWork(store, id);
}

}  // namespace

void DropWork(const Store& store, const std::string& job_id) {
  std::error_code ignored;
  std::filesystem::remove_all(store.directory.WorkFolder(job_id), ignored);
  std::filesystem::remove(store.directory.WorkerFolder(job_id), ignored);  // where nothing else is
}

void DropWorkOfDrive(Store& store, const std::string& drive_id) {
  // A job may have left drives out since that it has prepared.
  DropWorkOf(store,
             "SELECT id FROM jobs WHERE site = (SELECT site FROM drives WHERE id = ?) "
             "AND state NOT IN ('running', 'done')",
             drive_id);
}

void DropStaleWork(Store& store, std::chrono::system_clock::time_point now) {
  DropWorkOf(store, R"(
      SELECT id FROM jobs WHERE state = 'done'
        OR (state IN ('failed', 'cancelled')
            AND (finished_at < ?
                 OR EXISTS (SELECT 1 FROM job_drives JOIN drives ON drives.id = job_drives.drive
                              WHERE job_drives.job = jobs.id
                                AND (drives.deleted_at IS NOT NULL
                                     OR drives.log_deleted_at IS NOT NULL)))))",
             UtcText(now - kWorkLifetime));
}

}  // namespace parkade
