#pragma once

#include <cstdint>
#include <filesystem>

#include "server/ingest/checks/finding.h"

namespace parkade {

/// From what size on a log is looked at by its beginning first. [byte]
constexpr std::uint64_t kLargeLog = std::uint64_t{1} << 30;

/// The size of a file, or of all files below a folder, as far as they can be read. [byte]
std::uint64_t SizeOfLog(const std::filesystem::path& log);

/// Whether what the beginning of a log tells makes all of it unusable: units and mounting do not
/// change on the way. Rates of a car at rest may be zero, and coarse ones may not change; a
/// driver's first samples may hold halves.
bool IsLasting(const Finding& finding);

}  // namespace parkade
