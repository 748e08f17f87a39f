#include "server/ingest/files/byte_reader.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr std::size_t kSmallestStep = std::size_t{4} << 10;
constexpr std::size_t kLargestStep = std::size_t{256} << 10;

}  // namespace

std::span<const std::uint8_t> FileReader::Fetch(std::uint64_t offset, std::size_t count) {
  if (offset >= end_) return {};
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, end_ - offset));
  const std::uint64_t window_end = window_begin_ + window_.size();
  if (offset < window_begin_ || offset + count > window_end) {
    const bool goes_on = offset >= window_begin_ && offset <= window_end && !window_.empty();
    step_ = goes_on ? std::min(2 * step_, kLargestStep) : kSmallestStep;
    window_.resize(
        static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count, step_), end_ - offset)));
    window_.resize(file_->ReadAt(offset, window_));
    window_begin_ = offset;
  }
  const auto skip = static_cast<std::size_t>(offset - window_begin_);
  if (skip >= window_.size()) return {};
  return std::span(window_).subspan(skip, std::min(count, window_.size() - skip));
}

std::optional<std::string> ReadText(ByteReader& reader, std::uint64_t offset, std::uint64_t size,
                                    std::uint64_t max_size) {
  if (size > max_size) return std::nullopt;
  const std::span<const std::uint8_t> bytes = reader.Fetch(offset, static_cast<std::size_t>(size));
  if (bytes.size() < size) return std::nullopt;
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace parkade
