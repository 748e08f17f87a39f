#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace parkade {

/// What the rows of a table are about, by which its columns are known.
enum class TableKind { kImu, kWheels, kGnss, kImages };

/// Where the columns of EuRoC's order stand in a table with these names of columns, the stamp's
/// first: "time,ax,ay,az,gx,gy,gz" has its rates in the fifth to the seventh. Empty where the names
/// do not tell, or where the order is EuRoC's.
std::vector<std::size_t> ColumnsOf(const std::vector<std::string_view>& names, TableKind kind);

}  // namespace parkade
