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

/// What samples of one place of a camera's grid have in common: a camera looks at the same places of its car's plane
/// in every image, so that a sample is the number of its place, a colour, and what was seen there.
struct GroundPlace {
  CompactPoint point_in_body;
  CompactFloat weight, footprint, confidence;  ///< confidence: of the first sample there
};

/// The places of one camera by number, in the order in which samples first came from them.
class GroundPlaces {
 public:
  GroundPlaces() = default;
  explicit GroundPlaces(std::vector<GroundPlace> places) : places_(std::move(places)) {}

  /// Numbers of the samples' places; new places are added.
  std::vector<std::uint32_t> NumbersOf(std::span<const GroundSample> samples);

  std::span<const GroundPlace> places() const { return places_; }

 private:
  using Bytes = std::array<std::uint8_t, 10>;  // of the place but for its confidence
  struct Hash {
    std::size_t operator()(const Bytes& bytes) const {
      return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
  };

  std::vector<GroundPlace> places_;
  std::unordered_map<Bytes, std::uint32_t, Hash> numbers_;
};

/// The samples of a patch, compressed, exactly: 2 to 4 bytes each.
std::string EncodeSamples(std::span<const GroundSample> samples, GroundPlaces& places);

/// Throws Error{kInvalidInput} for bytes that are none.
std::vector<GroundSample> DecodeSamples(std::string_view bytes, std::size_t num_samples,
                                        std::span<const GroundPlace> places);

/// zstd with a checksum.
std::string Compress(std::string_view bytes);

/// Throws Error{kInvalidInput} unless `bytes` unfold to `size` bytes.
std::string Decompress(std::string_view bytes, std::size_t size);

}  // namespace parkade
