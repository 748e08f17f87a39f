#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/error.h"

namespace parkade {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

// One description of a struct serves both directions:
//
//   template <typename Archive>
//   void Exchange(Archive& archive, Place& place) { archive(place.time, place.name); }

/// Appends values to a string of bytes.
class BinaryWriter {
 public:
  template <typename... Values>
  void operator()(Values&... values) {
    (Put(values), ...);
  }
  const std::string& bytes() const { return bytes_; }

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

/// Takes values from bytes. Throws Error{kInvalidInput} where they end too early.
class BinaryReader {
 public:
  explicit BinaryReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (Put(values), ...);
  }
  bool is_at_end() const { return bytes_.empty(); }

  void Raw(void* data, size_t size) {
    Require(size <= bytes_.size(), ErrorCode::kInvalidInput, "the file ends in the middle");
    std::memcpy(data, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  std::uint64_t Count(std::uint64_t) {
    std::uint64_t count = 0;
    Raw(&count, sizeof count);
    Require(count <= bytes_.size(), ErrorCode::kInvalidInput, "the file holds a count that cannot be");
    return count;
  }

 private:
  template <typename Value>
  void Put(Value& value);

  std::string_view bytes_;
};

template <typename Archive, typename Value>
void ExchangeValue(Archive& archive, Value& value) {
  if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
    archive.Raw(&value, sizeof value);
  } else {
    Exchange(archive, value);
  }
}

template <typename Archive>
void ExchangeValue(Archive& archive, std::string& text) {
  text.resize(archive.Count(text.size()));
  archive.Raw(text.data(), text.size());
}

template <typename Archive, typename Item>
void ExchangeValue(Archive& archive, std::vector<Item>& items) {
  items.resize(archive.Count(items.size()));
  for (Item& item : items) archive(item);
}

template <typename Archive, typename Item>
void ExchangeValue(Archive& archive, std::optional<Item>& item) {
  bool has_value = item.has_value();
  archive(has_value);
  if (has_value && !item) item.emplace();
  if (!has_value) item.reset();
  if (item) archive(*item);
}

template <typename Archive, typename Item, size_t N>
void ExchangeValue(Archive& archive, std::array<Item, N>& items) {
  for (Item& item : items) archive(item);
}

template <typename Archive, typename Scalar, int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
void ExchangeValue(Archive& archive, Eigen::Matrix<Scalar, Rows, Columns, Options, MaxRows, MaxColumns>& matrix) {
  if constexpr (Rows == Eigen::Dynamic)
    matrix.resize(static_cast<Eigen::Index>(archive.Count(static_cast<std::uint64_t>(matrix.rows()))), Columns);
  archive.Raw(matrix.data(), sizeof(Scalar) * static_cast<size_t>(matrix.size()));
}

template <typename Archive>
void ExchangeValue(Archive& archive, Eigen::Quaterniond& rotation) {
  archive(rotation.coeffs());
}

template <typename Value>
void BinaryWriter::Put(Value& value) {
  ExchangeValue(*this, value);
}

template <typename Value>
void BinaryReader::Put(Value& value) {
  ExchangeValue(*this, value);
}

}  // namespace parkade
