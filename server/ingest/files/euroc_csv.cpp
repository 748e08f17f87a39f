#include "server/ingest/files/euroc_csv.h"

#include <cctype>
#include <charconv>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxLineLength = 4096;
constexpr std::string_view kBlanks = " \t\r";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::optional<Timestamp> ParseStamp(std::string_view text) {
  Timestamp stamp;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), stamp.ns);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return stamp;
}

}  // namespace

EurocCsv::EurocCsv(const std::filesystem::path& file, std::uint64_t offset)
    : stream_(file), buffer_(kMaxLineLength), offset_(offset), is_first_(offset == 0) {
  Require(stream_.is_open(), ErrorCode::kNotFound, "cannot open " + file.filename().string());
  stream_.seekg(static_cast<std::streamoff>(offset));
}

std::optional<EurocLine> EurocCsv::Next() {
  while (true) {
    const std::uint64_t begin = offset_;
    stream_.getline(buffer_.data(), kMaxLineLength);
    const auto length = static_cast<std::size_t>(stream_.gcount());
    offset_ += length;
    if (length == 0 && !stream_) return std::nullopt;
    if (stream_.fail()) {  // longer than the buffer
      stream_.clear();
      stream_.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
      offset_ += static_cast<std::uint64_t>(stream_.gcount());
      ++num_bad_lines_;
      continue;
    }
    // getline counts the newline that it takes out.
    const std::string_view line = Trimmed({buffer_.data(), stream_.eof() ? length : length - 1});
    if (line.empty() || line.front() == '#') continue;
    const std::optional<Timestamp> stamp = ParseStamp(SplitCsv(line).front());
    const bool is_first = std::exchange(is_first_, false);
    if (stamp) return EurocLine{*stamp, std::string(line), begin};
    // The names of the columns may stand without '#'.
    if (!is_first || std::isdigit(static_cast<unsigned char>(line.front())) != 0) ++num_bad_lines_;
  }
}

std::vector<std::string_view> SplitCsv(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(Trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> ParseDouble(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace parkade
