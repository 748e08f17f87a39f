#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"

namespace parkade {

// Rows of `file_checks`: when a stored file was last read and compared with what the database says
// of it, and what was wrong. Paths are relative to the data directory.

struct DamagedFile {
  std::string path;
  std::string damage;  ///< "is missing", "has changed on the disk"
};

/// `damage` is nothing for a file that is whole.
void SetFileCheck(Connection& connection, const std::string& path,
                  const std::optional<std::string>& damage);

/// What was wrong with a file when it was last checked, if anything.
std::optional<std::string> DamageOf(Connection& connection, const std::string& path);

/// Times of the last check by path; a file that was never checked is not there.
std::vector<std::pair<std::string, std::string>> FileCheckTimes(Connection& connection);

std::vector<DamagedFile> DamagedFiles(Connection& connection);
std::int64_t CountDamagedFiles(Connection& connection);

/// Forgets files that are not stored any more.
void DropFileCheck(Connection& connection, const std::string& path);

}  // namespace parkade
