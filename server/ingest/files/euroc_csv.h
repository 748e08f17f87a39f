#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// One line of an EuRoC data.csv: "1403715273262142976,...".
struct EurocLine {
  Timestamp stamp;
  std::string text;          ///< the whole line without its end
  std::uint64_t offset = 0;  ///< [byte] of the line in the file
};

/// Reads a data.csv line by line in constant memory. '#' comments and blank lines are skipped;
/// lines without a stamp, or longer than 4 KiB, are counted and skipped.
class EurocCsv {
 public:
  /// Begins with the line at `offset`. Throws Error{kNotFound} when the file cannot be opened.
  explicit EurocCsv(const std::filesystem::path& file, std::uint64_t offset = 0);

  std::optional<EurocLine> Next();
  std::uint64_t num_bad_lines() const { return num_bad_lines_; }

 private:
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::uint64_t offset_ = 0, num_bad_lines_ = 0;
  bool is_first_ = true;
};

/// The fields of a CSV line, without surrounding blanks.
std::vector<std::string_view> SplitCsv(std::string_view line);

/// The whole of `text` as a number; "nan" and "inf" are numbers. Nothing when it is not one.
std::optional<double> ParseDouble(std::string_view text);

}  // namespace parkade
