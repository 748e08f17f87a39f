#pragma once

#include <memory>
#include <optional>

#include "server/ingest/files/folder_stream.h"

namespace parkade {

/// The rows of a stream, in the order of their files. Each says, as a line of EuRoC does: an image
/// by the path of its file, anything else by its stamp and its numbers.
class FolderRows {
 public:
  virtual ~FolderRows() = default;
  virtual std::optional<EurocLine> Next() = 0;
  virtual const BadLines& bad_lines() const = 0;
};

/// Begins with the row at `place`, the offset of one that was read before. Throws
/// Error{kNotFound} when a table cannot be opened.
std::unique_ptr<FolderRows> OpenRows(const FolderStream& stream, std::uint64_t place = 0);

}  // namespace parkade
