#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"

namespace parkade {

enum class UploadSetState { kReceiving, kAssembling, kDone, kRefused };

/// "receiving", "assembling", "done", "refused".
const char* ToText(UploadSetState state);

/// A drive whose files arrive as uploads of their own, the rows of `uploads` that name the set.
struct UploadSet {
  std::string id;
  std::string filename;  ///< as the user calls the drive; may be empty
  std::optional<std::string> site, rig;
  std::int64_t bytes = 0;  ///< of the log that becomes of it
  UploadSetState state = UploadSetState::kReceiving;
  std::optional<std::string> error, error_code;  ///< why it was refused
  std::optional<std::string> drive;              ///< what it became
  std::string created_at, expires_at;
  std::optional<std::string> created_by;  ///< id of the token it began with
};

// Rows of `upload_sets`. What ends a set ends its parts, too.

void InsertUploadSet(Connection& connection, const UploadSet& set);

/// Throws Error{kNotFound}.
UploadSet FindUploadSet(Connection& connection, const std::string& id);

/// All that have not ended, oldest first.
std::vector<UploadSet> UnfinishedUploadSets(Connection& connection);
/// Those of them whose parts are all there.
std::vector<UploadSet> WholeUploadSets(Connection& connection);
/// Ids of sets whose time is over.
std::vector<std::string> ExpiredUploadSets(Connection& connection, const std::string& now);

void SetUploadSetAssembling(Connection& connection, const std::string& id);
void SetUploadSetDone(Connection& connection, const std::string& id, const std::string& drive);
void SetUploadSetRefused(Connection& connection, const std::string& id, const std::string& code,
                         const std::string& sentence);
void DeleteUploadSet(Connection& connection, const std::string& id);

/// Forgets all uploads and sets that have not ended.
void DeleteUnfinishedUploads(Connection& connection);

}  // namespace parkade
