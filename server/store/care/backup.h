#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "server/store/tables/check_table.h"

namespace parkade {

/// What a command on a whole data directory did.
struct CareReport {
  std::int64_t files = 0;  ///< that the database answers for
  std::int64_t bytes = 0;  ///< read or copied
  std::vector<DamagedFile> damaged;
};

/// Compares every stored file with what the database says of it: whether it is there, and `deep`
/// its content too. Writes nothing; a service may run meanwhile. Throws Error{kInvalidInput} where
/// there is no data directory, Error{kConflict} where another version of this program wrote it.
CareReport VerifyData(const std::filesystem::path& data, bool deep);

/// Brings `target` up to date: a data directory that holds the database as it is at one moment and
/// every file that it names, copied as what it should be or not at all. Files that are there are
/// kept. A service may run meanwhile. Waiting jobs are kept, running ones wait again, unfinished
/// uploads are left out. Throws as VerifyData does; Error{kDiskFull}.
CareReport BackUpData(const std::filesystem::path& data, const std::filesystem::path& target);

/// Makes the data directory `data` of a backup. Throws Error{kConflict} where there is one already.
CareReport RestoreData(const std::filesystem::path& backup, const std::filesystem::path& data);

}  // namespace parkade
