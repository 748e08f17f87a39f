#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/error.h"

namespace parkade {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

// One description of a struct serves both directions:
//
//   template <typename Archive>
//   void Serialize(Archive& archive, Place& place) { archive(place.time, place.name); }

/// Appends values to a string of bytes.
class BinaryWriter {
 public:
  template <typename... Values>
  void operator()(Values&... values) {
    (Put(values), ...);
  }
  const std::string& bytes() const { return bytes_; }
  std::string Take() && { return std::move(bytes_); }
  void Clear() { bytes_.clear(); }

  void Raw(void* data, size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  std::uint64_t Count(std::uint64_t count) {
    Raw(&count, sizeof count);
    return count;
  }

 private:
  template <typename Value>
  void Put(Value& value);

  std::string bytes_;
};

/// Takes values from bytes, of which `Source` delivers the next few at a time. Throws
/// Error{kInvalidInput} where they end too early.
template <typename Source>
class BinaryReaderOf {
 public:
  template <typename... Arguments>
  explicit BinaryReaderOf(Arguments&&... of_source)
      : source_(std::forward<Arguments>(of_source)...) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (Put(values), ...);
  }
  bool is_at_end() const { return source_.num_left() == 0; }
  std::uint64_t num_left() const { return source_.num_left(); }

  void Raw(void* data, size_t size) {
    Require(size <= source_.num_left(), ErrorCode::kInvalidInput, "the file ends in the middle");
    source_.Take(static_cast<char*>(data), size);
  }
  std::uint64_t Count(std::uint64_t) {
    std::uint64_t count = 0;
    Raw(&count, sizeof count);
    Require(count <= source_.num_left(), ErrorCode::kInvalidInput,
            "the file holds a count that cannot be");
    return count;
  }

 private:
  template <typename Value>
  void Put(Value& value);

  Source source_;
};

/// Borrows the bytes.
class BytesInMemory {
 public:
  explicit BytesInMemory(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t num_left() const { return bytes_.size(); }
  void Take(char* data, size_t size) {
    bytes_.copy(data, size);
    bytes_.remove_prefix(size);
  }

 private:
  std::string_view bytes_;
};

using BinaryReader = BinaryReaderOf<BytesInMemory>;

template <typename Archive, typename Value>
void SerializeValue(Archive& archive, Value& value) {
  if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
    archive.Raw(&value, sizeof value);
  } else {
    Serialize(archive, value);
  }
}

template <typename Archive>
void SerializeValue(Archive& archive, std::string& text) {
  text.resize(archive.Count(text.size()));
  archive.Raw(text.data(), text.size());
}

template <typename Archive, typename Item>
void SerializeValue(Archive& archive, std::vector<Item>& items) {
  items.resize(archive.Count(items.size()));
  if constexpr (std::is_arithmetic_v<Item>)
    archive.Raw(items.data(), items.size() * sizeof(Item));
  else
    for (Item& item : items) archive(item);
}

template <typename Archive, typename Item>
void SerializeValue(Archive& archive, std::optional<Item>& item) {
  bool has_value = item.has_value();
  archive(has_value);
  if (has_value && !item) item.emplace();
  if (!has_value) item.reset();
  if (item) archive(*item);
}

template <typename Archive, typename First, typename Second>
void SerializeValue(Archive& archive, std::pair<First, Second>& pair) {
  archive(pair.first, pair.second);
}

template <typename Archive, typename Key, typename Item>
void SerializeValue(Archive& archive, std::map<Key, Item>& items) {
  const std::uint64_t count = archive.Count(items.size());
  if constexpr (std::is_same_v<Archive, BinaryWriter>) {
    for (auto& [key, item] : items) {
      Key written = key;
      archive(written, item);
    }
  } else {
    std::vector<std::pair<Key, Item>> list(count);
    for (auto& [key, item] : list) archive(key, item);
    items = {std::make_move_iterator(list.begin()), std::make_move_iterator(list.end())};
  }
}

template <typename Archive, typename Item, size_t N>
void SerializeValue(Archive& archive, std::array<Item, N>& items) {
  for (Item& item : items) archive(item);
}

template <typename Archive, typename Scalar, int Rows, int Columns, int Options, int MaxRows,
          int MaxColumns>
void SerializeValue(Archive& archive,
                    Eigen::Matrix<Scalar, Rows, Columns, Options, MaxRows, MaxColumns>& matrix) {
  const auto count = [&archive](Eigen::Index size) {
    return static_cast<Eigen::Index>(archive.Count(static_cast<std::uint64_t>(size)));
  };
  const Eigen::Index rows = Rows == Eigen::Dynamic ? count(matrix.rows()) : Rows;
  const Eigen::Index columns = Columns == Eigen::Dynamic ? count(matrix.cols()) : Columns;
  matrix.resize(rows, columns);  // nothing happens where it has that size already
  archive.Raw(matrix.data(), sizeof(Scalar) * static_cast<size_t>(matrix.size()));
}

template <typename Archive>
void SerializeValue(Archive& archive, Eigen::Quaterniond& rotation) {
  archive(rotation.coeffs());
}

template <typename Value>
void BinaryWriter::Put(Value& value) {
  SerializeValue(*this, value);
}

template <typename Source>
template <typename Value>
void BinaryReaderOf<Source>::Put(Value& value) {
  SerializeValue(*this, value);
}

}  // namespace parkade
