#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/ground_patch.h"

namespace parkade {

/// The part that samples of one cell of a camera's grid have in common: a camera looks at the same
/// cells of its car's plane in every image, so that a sample is the number of its cell, a color,
/// and what was seen there.
struct GroundCell {
  CompactPoint point_in_body;
  CompactFloat weight, footprint, confidence;  ///< confidence: of the first sample there
};

/// The cells of one camera by number, in the order in which samples first came from them.
class GroundCells {
 public:
  GroundCells() = default;
  explicit GroundCells(std::vector<GroundCell> cells) : cells_(std::move(cells)) {}

  /// Returns the numbers of the samples' cells; adds new cells.
  std::vector<std::uint32_t> NumbersOf(std::span<const GroundSample> samples);

  std::span<const GroundCell> cells() const { return cells_; }

 private:
  using Bytes = std::array<std::uint8_t, 10>;  // the cell but for its confidence
  template <typename Place>
  static Bytes BytesOf(const Place& place);
  struct Hash {
    std::size_t operator()(const Bytes& bytes) const {
      return std::hash<std::string_view>{}(
          {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
  };

  std::vector<GroundCell> cells_;
  std::unordered_map<Bytes, std::uint32_t, Hash> numbers_;
};

/// Compresses the samples of a patch exactly, to 2 to 4 bytes each.
std::string EncodeSamples(std::span<const GroundSample> samples, GroundCells& cells);

/// The inverse of EncodeSamples. Throws Error{kInvalidInput} for other bytes.
std::vector<GroundSample> DecodeSamples(std::string_view bytes, std::size_t num_samples,
                                        std::span<const GroundCell> cells);

/// Compresses by zstd, with a checksum.
std::string Compress(std::string_view bytes);

/// Unpacks. Throws Error{kInvalidInput} unless `bytes` unfold to `size` bytes.
std::string Decompress(std::string_view bytes, std::size_t size);

}  // namespace parkade
