#include "server/http/routes/look_record.h"

#include <chrono>

#include "server/store/access/audit_log.h"
#include "server/store/access/caller.h"

namespace parkade {

void LookRecord::Note(Database& database, const std::string& drive) {
  constexpr size_t kMaxKnown = 10000;
  const Caller& caller = CurrentCaller();
  const std::string key = caller.id + "/" + caller.name + "/" + drive;
  const std::int64_t hour = std::chrono::duration_cast<std::chrono::hours>(
                                std::chrono::system_clock::now().time_since_epoch())
                                .count();
  const std::lock_guard lock(mutex_);
  if (const auto known = hours_.find(key); known != hours_.end() && known->second == hour) return;
  database.Write([&](Connection& connection) { RecordAudit(connection, "pictures.see", drive); });
  if (hours_.size() >= kMaxKnown) hours_.clear();
  hours_[key] = hour;
}

}  // namespace parkade
