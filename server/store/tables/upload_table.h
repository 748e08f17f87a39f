#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"

namespace parkade {

enum class UploadState { kReceiving, kDone, kRefused };

/// "receiving", "done", "refused".
const char* ToText(UploadState state);

/// A log that arrives in parts, or one part of the drive of an upload set.
struct Upload {
  std::int64_t sequence = 0;
  std::string id;
  std::string metadata;  ///< as the client sent it
  std::string filename;  ///< as the user calls it; may be empty
  std::optional<std::string> site, rig;
  std::optional<std::string> sha256;  ///< that the client announced
  std::int64_t length = 0;            ///< [bytes]
  std::int64_t offset = 0;            ///< [bytes] that are durable
  UploadState state = UploadState::kReceiving;
  std::optional<std::string> error, error_code;  ///< why it was refused
  std::optional<std::string> drive;              ///< what it became
  std::string created_at, expires_at;
  std::optional<std::string> created_by;  ///< id of the token it began with
  std::optional<std::string> set;   ///< it is a part of; with it, done means: there as a whole
  std::optional<std::string> path;  ///< in the set
  std::int64_t first_byte = 0;      ///< where its bytes begin in its file
};

// Rows of `uploads`.

void InsertUpload(Connection& connection, const Upload& upload);

/// Throws Error{kNotFound}.
Upload FindUpload(Connection& connection, const std::string& id);

bool HasUpload(Connection& connection, const std::string& id);

/// All that have not ended, oldest first.
std::vector<Upload> UnfinishedUploads(Connection& connection);
/// The parts of an upload set, in order of their places.
std::vector<Upload> UploadsOfSet(Connection& connection, const std::string& set);
/// Ids of uploads whose time is over; those of a set end with it.
std::vector<std::string> ExpiredUploads(Connection& connection, const std::string& now);

/// While it is receiving. A set lives on with each of its parts.
void SetUploadOffset(Connection& connection, const std::string& id, std::int64_t offset,
                     const std::string& expires_at);
/// Notes that a part of a set is there.
void SetUploadWhole(Connection& connection, const std::string& id);
void SetUploadDone(Connection& connection, const std::string& id, const std::string& drive);
void SetUploadRefused(Connection& connection, const std::string& id, const std::string& code,
                      const std::string& sentence);
void DeleteUpload(Connection& connection, const std::string& id);

}  // namespace parkade
