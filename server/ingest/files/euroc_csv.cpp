#include "server/ingest/files/euroc_csv.h"

#include <cctype>
#include <charconv>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxLineLength = 4096;
constexpr std::string_view kBlanks = " \t\r", kByteOrderMark = "\xEF\xBB\xBF";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::string_view WithoutQuotes(std::string_view field) {
  field = Trimmed(field);
  if (field.size() < 2 || field.front() != '"' || field.back() != '"') return field;
  return Trimmed(field.substr(1, field.size() - 2));
}

/// What parts the fields of a line: semicolons where numbers may have decimal commas.
char SeparatorOf(std::string_view line) {
  for (const char separator : {';', ',', '\t'})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

/// "1,5" as "1.5".
std::string WithPoint(std::string_view field) {
  std::string text(field);
  if (field.find_first_not_of("+-0123456789,eE") == std::string_view::npos)
    if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
  return text;
}

/// Without units and remarks in brackets, which may hold any separators.
std::string WithoutBrackets(std::string_view row) {
  std::string kept;
  int depth = 0;
  for (const char c : row) {
    if (c == '(' || c == '[') ++depth;
    if (depth == 0) kept += c;
    if ((c == ')' || c == ']') && depth > 0) --depth;
  }
  return kept;
}

/// The fields in the order of the format, the stamp first.
std::vector<std::string> FieldsOf(std::string_view line, const TableFormat& format) {
  const std::vector<std::string_view> found = SplitCsv(line);
  const bool has_decimal_commas = SeparatorOf(line) == ';';
  std::vector<std::string> fields;
  const auto take = [&](std::size_t column) {
    const std::string_view field = column < found.size() ? found[column] : std::string_view{};
    fields.push_back(has_decimal_commas ? WithPoint(field) : std::string(field));
  };
  for (const std::size_t column : format.columns) take(column);
  if (format.columns.empty())
    for (std::size_t column = 0; column < found.size(); ++column) take(column);
  return fields;
}

std::string Joined(const std::vector<std::string>& fields) {
  std::string line = fields.front();
  for (std::size_t i = 1; i < fields.size(); ++i) line.append(",").append(fields[i]);
  return line;
}

}  // namespace

EurocCsv::EurocCsv(const std::filesystem::path& file, TableFormat format, std::uint64_t offset)
    : stream_(file),
      format_(std::move(format)),
      buffer_(kMaxLineLength),
      offset_(offset),
      is_before_first_(offset == 0) {
  Require(stream_.is_open(), ErrorCode::kNotFound, "cannot open " + file.filename().string());
  stream_.seekg(static_cast<std::streamoff>(offset));
}

std::optional<EurocLine> EurocCsv::Next() {
  while (true) {
    const std::uint64_t begin = offset_;
    stream_.getline(buffer_.data(), kMaxLineLength);
    const auto length = static_cast<std::size_t>(stream_.gcount());
    offset_ += length;
    ++num_lines_;
    if (length == 0 && !stream_) return std::nullopt;
    if (stream_.fail()) {  // longer than the buffer
      stream_.clear();
      stream_.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
      offset_ += static_cast<std::uint64_t>(stream_.gcount());
      CountBad({buffer_.data(), kMaxLineLength - 1});
      continue;
    }
    // getline counts the newline that it takes out.
    std::string_view line(buffer_.data(), stream_.eof() ? length : length - 1);
    if (begin == 0 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    line = Trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string> fields = FieldsOf(line, format_);
    if (const auto stamp = ParseStamp(fields.front(), format_.unit)) {
      is_before_first_ = false;
      return EurocLine{*stamp, Joined(fields), begin};
    }
    // The names of the columns may stand without '#'.
    if (!is_before_first_ || std::isdigit(static_cast<unsigned char>(line.front())) != 0)
      CountBad(line);
  }
}

void EurocCsv::CountBad(std::string_view line) {
  constexpr std::size_t kMaxShown = 40;
  if (bad_lines_.count++ > 0) return;
  bad_lines_.first = "line " + std::to_string(num_lines_) + ", '" +
                     std::string(line.substr(0, kMaxShown)) +
                     (line.size() > kMaxShown ? "...'" : "'");
}

TableFormat FormatOf(const std::filesystem::path& file, TableKind kind) {
  constexpr std::size_t kEnough = 50, kMaxLines = 500;
  std::ifstream stream(file);
  Require(stream.is_open(), ErrorCode::kNotFound, "cannot open " + file.filename().string());
  TableFormat format;
  std::vector<std::string> stamps;
  std::string line;
  for (std::size_t i = 0; i < kMaxLines && stamps.size() < kEnough; ++i) {
    line.resize(kMaxLineLength);
    stream.getline(line.data(), kMaxLineLength);
    if (!stream) break;
    line.resize(static_cast<std::size_t>(stream.gcount()) - (stream.eof() ? 0 : 1));
    if (i == 0 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    std::string_view row = Trimmed(line);
    const bool is_comment = row.starts_with('#');
    if (is_comment) row.remove_prefix(1);
    if (row.empty()) continue;
    const std::vector<std::string> fields = FieldsOf(row, format);
    if (!is_comment && ParseStamp(fields.front(), format.unit))
      stamps.push_back(fields.front());
    else if (stamps.empty() && format.columns.empty())
      format.columns = ColumnsOf(SplitCsv(WithoutBrackets(row)), kind);
  }
  format.unit = UnitOf(stamps, kind);
  return format;
}

StampUnit UnitOf(const std::vector<std::string>& stamps, TableKind kind) {
  // [s] An inertial sensor has up to 2.5 kHz, others 250 Hz.
  return kind == TableKind::kImu ? UnitOf(stamps, 4e-4, 0.5) : UnitOf(stamps, 4e-3, 5);
}

std::vector<std::string_view> SplitCsv(std::string_view line) {
  const char separator = SeparatorOf(line);
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = line.find(separator);
    fields.push_back(WithoutQuotes(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = Trimmed(line);  // columns may be lined up
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
