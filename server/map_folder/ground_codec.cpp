#include "server/map_folder/ground_codec.h"

#include <zstd.h>

#include <bit>
#include <cstring>
#include <memory>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kCompressionLevel =
    1;  // higher ones take longer and save little: the rest is image noise

// Bytes of samples stand plane by plane: all first bytes, then all second ones. Colors and numbers
// are differences from the sample before, and those of blue and red from the one of green.
enum Plane : std::size_t {
  kNumber0,
  kNumber1,
  kNumber2,
  kNumber3,
  kGreen,
  kBlue,
  kRed,
  kKind,
  kConfidence0,
  kConfidence1,
  kNumPlanes
};

static_assert(sizeof(CompactPoint) == 6 && sizeof(CompactFloat) == 2);

std::uint16_t BitsOf(const CompactFloat& value) { return std::bit_cast<std::uint16_t>(value); }

CompactFloat FromBits(std::uint16_t bits) { return std::bit_cast<CompactFloat>(bits); }

/// Maps small numbers of either sign to small numbers without one.
std::uint32_t Fold(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}
std::int32_t Unfold(std::uint32_t value) {
  return static_cast<std::int32_t>(value >> 1) ^ -static_cast<std::int32_t>(value & 1);
}

/// Fills `unpacked`; throws Error{kInvalidInput} unless `bytes` unfold to just that.
void DecompressInto(std::span<char> unpacked, std::string_view bytes) {
  thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                                  &ZSTD_freeDCtx);
  const std::size_t got = ZSTD_decompressDCtx(context.get(), unpacked.data(), unpacked.size(),
                                              bytes.data(), bytes.size());
  Require(ZSTD_isError(got) == 0 && got == unpacked.size(), ErrorCode::kInvalidInput,
          "it holds a damaged piece");
}

/// A sample's class and whether it is free.
std::uint8_t PackKind(const GroundSample& sample) {
  const auto surface = static_cast<unsigned>(sample.surface);
  return static_cast<std::uint8_t>(surface << 1U | unsigned{sample.is_free});
}
void UnpackKind(unsigned kind, GroundSample& sample) {
  const auto surface = static_cast<SurfaceClass>(kind >> 1U);
  sample.is_free = (kind & 1U) != 0;
  sample.surface = surface <= SurfaceClass::kUnknown ? surface : SurfaceClass::kUnknown;
}

std::uint8_t Minus(std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a - b); }
std::uint8_t Plus(std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + b); }

}  // namespace

template <typename Place>
GroundCells::Bytes GroundCells::BytesOf(const Place& place) {
  Bytes bytes;
  std::memcpy(bytes.data(), &place.point_in_body, 6);
  std::memcpy(bytes.data() + 6, &place.weight, 2);
  std::memcpy(bytes.data() + 8, &place.footprint, 2);
  return bytes;
}

std::vector<std::uint32_t> GroundCells::NumbersOf(std::span<const GroundSample> samples) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(samples.size());
  std::size_t next = 0;  // most often
  for (const GroundSample& sample : samples) {
    const Bytes bytes = BytesOf(sample);
    if (next >= cells_.size() || BytesOf(cells_[next]) != bytes) {
      const auto [found, is_new] =
          numbers_.try_emplace(bytes, static_cast<std::uint32_t>(cells_.size()));
      if (is_new)
        cells_.push_back(
            {sample.point_in_body, sample.weight, sample.footprint, sample.confidence});
      next = found->second;
    }
    numbers.push_back(static_cast<std::uint32_t>(next));
    ++next;
  }
  return numbers;
}

std::string EncodeSamples(std::span<const GroundSample> samples, GroundCells& cells) {
  const std::size_t count = samples.size();
  const std::vector<std::uint32_t> numbers = cells.NumbersOf(samples);
  std::string planes(kNumPlanes * count, '\0');
  const auto at = [&](std::size_t plane, std::size_t i) -> std::uint8_t& {
    return reinterpret_cast<std::uint8_t&>(planes[plane * count + i]);
  };
  GroundSample last;
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const GroundSample& sample = samples[i];
    const std::uint32_t step = Fold(static_cast<std::int32_t>(numbers[i] - next));
    next = numbers[i] + 1;
    for (std::size_t k = 0; k < 4; ++k)
      at(kNumber0 + k, i) = static_cast<std::uint8_t>(step >> (8 * k));
    const std::uint8_t green = Minus(sample.green, last.green);
    at(kGreen, i) = green;
    at(kBlue, i) = Minus(Minus(sample.blue, last.blue), green);
    at(kRed, i) = Minus(Minus(sample.red, last.red), green);
    at(kKind, i) = PackKind(sample) ^ PackKind(last);
    const auto confidence = static_cast<std::uint16_t>(
        BitsOf(sample.confidence) ^ BitsOf(cells.cells()[numbers[i]].confidence));
    at(kConfidence0, i) = static_cast<std::uint8_t>(confidence);
    at(kConfidence1, i) = static_cast<std::uint8_t>(confidence >> 8);
    last = sample;
  }
  return Compress(planes);
}

std::vector<GroundSample> DecodeSamples(std::string_view bytes, std::size_t num_samples,
                                        std::span<const GroundCell> cells) {
  thread_local std::string
      planes;  // kept between calls: allocating it costs more than the work done in it
  if (planes.size() < kNumPlanes * num_samples) planes.resize(kNumPlanes * num_samples);
  DecompressInto({planes.data(), kNumPlanes * num_samples}, bytes);
  const auto at = [&](std::size_t plane, std::size_t i) {
    return static_cast<std::uint8_t>(planes[plane * num_samples + i]);
  };
  std::vector<GroundSample> samples(num_samples);
  GroundSample last;
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < num_samples; ++i) {
    const std::uint32_t step = at(kNumber0, i) | static_cast<std::uint32_t>(at(kNumber1, i)) << 8 |
                               static_cast<std::uint32_t>(at(kNumber2, i)) << 16 |
                               static_cast<std::uint32_t>(at(kNumber3, i)) << 24;
    const std::uint32_t number = next + static_cast<std::uint32_t>(Unfold(step));
    next = number + 1;
    Require(number < cells.size(), ErrorCode::kInvalidInput, "it holds a sample of no place");
    const GroundCell& cell = cells[number];
    GroundSample& sample = samples[i];
    const std::uint8_t green = at(kGreen, i);
    sample.point_in_body = cell.point_in_body;
    sample.green = Plus(last.green, green);
    sample.blue = Plus(last.blue, Plus(at(kBlue, i), green));
    sample.red = Plus(last.red, Plus(at(kRed, i), green));
    UnpackKind(unsigned{PackKind(last)} ^ at(kKind, i), sample);
    sample.weight = cell.weight;
    sample.footprint = cell.footprint;
    sample.confidence = FromBits(static_cast<std::uint16_t>(
        BitsOf(cell.confidence) ^
        (at(kConfidence0, i) | static_cast<unsigned>(at(kConfidence1, i)) << 8)));
    last = sample;
  }
  return samples;
}

std::string Compress(std::string_view bytes) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     &ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size());
  Require(ZSTD_isError(size) == 0, ErrorCode::kInternal, "zstd cannot compress");
  packed.resize(size);
  return packed;
}

std::string Decompress(std::string_view bytes, std::size_t size) {
  std::string unpacked(size, '\0');
  DecompressInto(unpacked, bytes);
  return unpacked;
}

}  // namespace parkade
