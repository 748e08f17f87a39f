#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/files/input_file.h"
#include "server/ingest/files/temporary_file.h"

namespace parkade {

struct UnpackedFile {
  std::shared_ptr<const TemporaryFile> file;  ///< null: its first bytes were refused
  DamageReport damage;  ///< a file that is cut off or damaged is unpacked up to that point
};

/// Unpacks a zstd file into a temporary one in `folder`. `accepts` is shown its first 16 bytes
/// before anything is written. Throws Error{kDiskFull}.
UnpackedFile UnpackZstdFile(const InputFile& packed, const std::filesystem::path& folder,
                            const std::function<bool(std::string_view)>& accepts);

}  // namespace parkade
