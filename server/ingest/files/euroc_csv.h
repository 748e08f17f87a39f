#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/files/column_names.h"
#include "server/ingest/files/stamp_text.h"

namespace parkade {

/// How a table is written.
struct TableFormat {
  StampUnit unit = StampUnit::kNanoseconds;
  /// Where the stamp stands, and then the columns of EuRoC's order; empty: in that order.
  std::vector<std::size_t> columns = {};
};

/// One line of an EuRoC data.csv: "1403715273262142976,...".
struct EurocLine {
  Timestamp stamp;
  std::string text;          ///< the fields of the line between commas, with decimal points
  std::uint64_t offset = 0;  ///< [byte] of the line in the file
};

/// Lines that cannot be read.
struct BadLines {
  std::uint64_t count = 0;
  std::string first;  ///< "line 7, 'banana,0.01'"
};

/// Reads a data.csv line by line in constant memory. '#' comments, blank lines and those before the
/// first stamp, which name the columns, are skipped; lines without a stamp, or longer than 4 KiB,
/// are counted and skipped. Columns are parted by semicolons, commas, tabs or blanks.
class EurocCsv {
 public:
  /// Begins with the line at `offset`. Throws Error{kNotFound} when the file cannot be opened.
  explicit EurocCsv(const std::filesystem::path& file, TableFormat format = {},
                    std::uint64_t offset = 0);

  std::optional<EurocLine> Next();
  const BadLines& bad_lines() const { return bad_lines_; }

 private:
  void CountBad(std::string_view line);

  std::ifstream stream_;
  TableFormat format_;
  std::vector<char> buffer_;
  std::uint64_t offset_ = 0, num_lines_ = 0;
  BadLines bad_lines_;
  bool is_before_first_ = true;
};

/// Tells a table's format by its head: the unit by the stamps, the order of the columns by their
/// names where these tell all. Throws as EurocCsv.
TableFormat FormatOf(const std::filesystem::path& file, TableKind kind);

/// The unit of the stamps of a kind of table.
StampUnit UnitOf(const std::vector<std::string>& stamps, TableKind kind);

/// The fields of a line, without surrounding blanks and quotes.
std::vector<std::string_view> SplitCsv(std::string_view line);

/// The whole of `text` as a number; "nan" and "inf" are numbers. Nothing when it is not one.
std::optional<double> ParseDouble(std::string_view text);

}  // namespace parkade
