#pragma once

#include <string>

#include "server/store/job_queue.h"
#include "server/store/publish_map.h"
#include "server/store/tables/map_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {

/// A store whose site "lot" has one version, made from one drive.
class PublishedSite : public StoreTest {
 protected:
  /// Publishes what stands at the head of the queue.
  MapVersion PublishNext() {
    const Job job = *ClaimJob(store_);
    const auto staging = store_.directory.AttemptFolder(job.id, job.attempt) / "out";
    WriteText(staging / "map.glb", "glTF of " + job.id);
    WriteText(staging / "report.json", report_);
    return PublishMap(store_, job, *SealMap(staging));
  }
  /// Another version of the same drives.
  MapVersion PublishAgain() {
    QueueMap(store_, "lot", {}, true);
    return PublishNext();
  }
  MapVersion Version(std::int64_t version) {
    return store_.database.Read(
        [&](Connection& connection) { return FindMap(connection, "lot", version); });
  }

  std::string report_ = R"({"datum": null, "bounds": null, "drives": []})";
  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  MapVersion map_ = PublishNext();
};

/// The error that `action` throws; fails the test where it throws none.
template <typename Action>
Error ErrorOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {ErrorCode::kInternal, ""};
}

}  // namespace parkade
