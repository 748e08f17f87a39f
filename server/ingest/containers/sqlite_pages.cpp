#include "server/ingest/containers/sqlite_pages.h"

#include <algorithm>
#include <array>
#include <bit>

#include "server/ingest/containers/log_record.h"

namespace parkade {
namespace {

constexpr std::uint8_t kTableLeaf = 0x0D;

std::uint32_t BigEndian(std::span<const std::uint8_t> bytes, std::size_t offset, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

/// Takes a variable-length integer off the front.
std::optional<std::uint64_t> TakeVarint(std::span<const std::uint8_t>& bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 9 && i < bytes.size(); ++i) {
    value = i == 8 ? value << 8 | bytes[i] : value << 7 | (bytes[i] & 0x7F);
    if (i < 8 && (bytes[i] & 0x80) != 0) continue;
    bytes = bytes.subspan(i + 1);
    return value;
  }
  return std::nullopt;
}

/// Bytes of a column by its serial type.
std::uint64_t SizeOfSerialType(std::uint64_t type) {
  constexpr std::array<std::uint64_t, 12> kSizes = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0, 0, 0};
  return type < kSizes.size() ? kSizes[type] : (type - 12) / 2;
}

bool IsInteger(std::uint64_t type) { return (type >= 1 && type <= 6) || type == 8 || type == 9; }
bool IsBlob(std::uint64_t type) { return type >= 12 && type % 2 == 0; }
bool IsText(std::uint64_t type) { return type >= 13 && type % 2 == 1; }

struct Columns {
  std::vector<std::uint64_t> types;
  std::span<const std::uint8_t> values;  ///< as far as they lie on the page
};

std::optional<Columns> ParseColumns(std::span<const std::uint8_t> payload) {
  std::span<const std::uint8_t> rest = payload;
  const auto header_size = TakeVarint(rest);
  if (!header_size || *header_size > payload.size() || *header_size < payload.size() - rest.size())
    return std::nullopt;
  Columns columns;
  columns.values = payload.subspan(static_cast<std::size_t>(*header_size));
  rest = rest.first(rest.size() - columns.values.size());
  while (!rest.empty() && columns.types.size() < 16) {
    const auto type = TakeVarint(rest);
    if (!type) return std::nullopt;
    columns.types.push_back(*type);
  }
  return columns;
}

std::optional<std::int64_t> TakeInteger(std::span<const std::uint8_t>& values, std::uint64_t type) {
  if (type == 8 || type == 9) return static_cast<std::int64_t>(type - 8);
  const std::uint64_t size = SizeOfSerialType(type);
  if (size > values.size()) return std::nullopt;
  std::uint64_t value = (values[0] & 0x80) != 0 ? ~std::uint64_t{0} : 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | values[i];
  values = values.subspan(static_cast<std::size_t>(size));
  return static_cast<std::int64_t>(value);
}

std::optional<std::string> TakeText(std::span<const std::uint8_t>& values, std::uint64_t type) {
  const std::uint64_t size = SizeOfSerialType(type);
  if (size > values.size()) return std::nullopt;
  const auto text = values.first(static_cast<std::size_t>(size));
  values = values.subspan(text.size());
  return std::string(text.begin(), text.end());
}

}  // namespace

SqlitePages::SqlitePages(std::shared_ptr<const InputFile> file) : file_(std::move(file)) {
  std::array<std::uint8_t, 100> header{};
  file_->ReadAt(0, header);
  const std::uint32_t claimed = BigEndian(header, 16, 2);
  const std::uint32_t size = claimed == 1 ? 65536 : claimed;
  if (size >= 512 && std::has_single_bit(size)) page_size_ = size;
  usable_size_ = page_size_ - (header[20] <= page_size_ - 480 ? header[20] : 0);
  num_pages_ = file_->size() / page_size_;
}

bool SqlitePages::LoadLeaf(std::uint64_t page) {
  page_.resize(page_size_);
  if (file_->ReadAt(page * page_size_, page_) < page_size_) return false;
  page_header_ = page == 0 ? 100 : 0;
  if (page_[page_header_] != kTableLeaf) return false;
  num_cells_ = BigEndian(page_, page_header_ + 3, 2);
  return 8 + 2 * num_cells_ <= page_size_ - page_header_;
}

std::optional<SqlitePages::Cell> SqlitePages::CellAt(std::size_t index) const {
  const std::size_t offset = BigEndian(page_, page_header_ + 8 + 2 * index, 2);
  if (offset >= usable_size_) return std::nullopt;
  std::span<const std::uint8_t> rest = std::span(page_).first(usable_size_).subspan(offset);
  const auto size = TakeVarint(rest);
  const auto row_id = size ? TakeVarint(rest) : std::nullopt;
  if (!row_id) return std::nullopt;
  Cell cell{static_cast<std::int64_t>(*row_id), *size, {}, 0};
  // The part of a payload that stays on its page: fileformat2, 1.6.
  const std::uint64_t most = usable_size_ - 35;
  std::uint64_t local = *size;
  if (*size > most) {
    const std::uint64_t least = (usable_size_ - 12) * 32 / 255 - 23;
    const std::uint64_t fitting = least + (*size - least) % (usable_size_ - 4);
    local = fitting <= most ? fitting : least;
    if (local + 4 > rest.size()) return std::nullopt;
    cell.overflow_page = BigEndian(rest, static_cast<std::size_t>(local), 4);
  }
  if (local > rest.size()) return std::nullopt;
  cell.local = rest.first(static_cast<std::size_t>(local));
  return cell;
}

std::map<std::int64_t, SqlitePages::Topic> SqlitePages::FindTopics() {
  std::map<std::int64_t, Topic> topics;
  for (std::uint64_t page = 0; page < num_pages_; ++page) {
    if (!LoadLeaf(page)) continue;
    for (std::size_t i = 0; i < num_cells_; ++i) {
      const auto cell = CellAt(i);
      const auto columns = cell ? ParseColumns(cell->local) : std::nullopt;
      // id, name, type, serialization_format, offered_qos_profiles[, type_description_hash]
      if (!columns || columns->types.size() < 4 || columns->types.size() > 6 ||
          columns->types[0] != 0)
        continue;
      if (!std::all_of(columns->types.begin() + 1, columns->types.begin() + 4, IsText)) continue;
      std::span<const std::uint8_t> values = columns->values;
      const auto name = TakeText(values, columns->types[1]);
      const auto type = TakeText(values, columns->types[2]);
      const auto encoding = TakeText(values, columns->types[3]);
      if (name && type && encoding && name->starts_with('/'))
        topics.try_emplace(cell->row_id, Topic{*name, *type, *encoding});
    }
  }
  return topics;
}

std::optional<SqlitePages::Row> SqlitePages::Next(const std::function<bool(std::int64_t)>& wants) {
  while (true) {
    if (next_cell_ >= num_cells_) {
      if (next_page_ >= num_pages_) return std::nullopt;
      num_cells_ = LoadLeaf(next_page_++) ? num_cells_ : 0;
      next_cell_ = 0;
      continue;
    }
    const auto cell = CellAt(next_cell_++);
    auto row = cell ? ParseMessage(*cell, wants) : std::nullopt;
    if (row) return row;
  }
}

std::optional<SqlitePages::Row> SqlitePages::ParseMessage(
    const Cell& cell, const std::function<bool(std::int64_t)>& wants) const {
  const auto columns = ParseColumns(cell.local);
  // id (the row's own), topic_id, timestamp, data
  if (!columns || columns->types.size() != 4 || columns->types[0] != 0 ||
      !IsInteger(columns->types[1]) || !IsInteger(columns->types[2]) || !IsBlob(columns->types[3]))
    return std::nullopt;
  std::span<const std::uint8_t> values = columns->values;
  const auto topic_id = TakeInteger(values, columns->types[1]);
  const auto timestamp = topic_id ? TakeInteger(values, columns->types[2]) : std::nullopt;
  const std::uint64_t data_size = SizeOfSerialType(columns->types[3]);
  constexpr std::uint64_t kMaxBesideData = 64;  // the header, an id and a time
  if (!timestamp || data_size > cell.size || cell.size - data_size > kMaxBesideData)
    return std::nullopt;
  Row row{cell.row_id, *topic_id, *timestamp, std::nullopt};
  if (!wants(*topic_id) || data_size > kMaxMessageSize) return row;
  row.data = ReadPayload(cell);
  if (!row.data || row.data->size() < data_size) {
    row.data.reset();
    return row;
  }
  row.data->erase(row.data->begin(), row.data->end() - static_cast<std::ptrdiff_t>(data_size));
  return row;
}

std::optional<std::vector<std::uint8_t>> SqlitePages::ReadPayload(const Cell& cell) const {
  std::vector<std::uint8_t> payload(cell.local.begin(), cell.local.end());
  std::vector<std::uint8_t> piece(usable_size_);
  std::uint32_t page = cell.overflow_page;
  while (payload.size() < cell.size) {
    if (page == 0 || page > num_pages_) return std::nullopt;
    if (file_->ReadAt(std::uint64_t{page - 1} * page_size_, piece) <
        std::min<std::uint64_t>(piece.size(), 4 + cell.size - payload.size()))
      return std::nullopt;
    const std::uint64_t count =
        std::min<std::uint64_t>(usable_size_ - 4, cell.size - payload.size());
    payload.insert(payload.end(), piece.begin() + 4,
                   piece.begin() + 4 + static_cast<std::ptrdiff_t>(count));
    page = BigEndian(piece, 0, 4);
  }
  return payload;
}

}  // namespace parkade
