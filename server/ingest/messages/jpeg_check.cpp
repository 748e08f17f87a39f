#include "server/ingest/messages/jpeg_check.h"

#include <algorithm>
#include <cstring>

#include "server/ingest/messages/jpeg_bits.h"
#include "server/ingest/messages/jpeg_header.h"

namespace parkade {
namespace {

constexpr std::int64_t kMaxEnergy = 1200 * 1200;

constexpr std::uint8_t kRst0 = 0xd0, kRst7 = 0xd7, kSoi = 0xd8, kEoi = 0xd9;

class JpegChecker {
 public:
  explicit JpegChecker(std::span<const std::uint8_t> data) : data_(data) {}

  /// False for a file of a kind that is not checked. Throws JpegDamage.
  bool Run() {
    std::size_t position = 2;  // behind SOI
    while (true) {
      position = FindMarker(position);
      const std::uint8_t marker = data_[position++];
      if (marker == kEoi) break;
      if (marker == kSoi || (marker >= kRst0 && marker <= kRst7))
        ReportJpegDamage("a marker at a wrong place");
      CheckJpeg(position + 2 <= data_.size(), "it ends inside a marker segment");
      const std::size_t length =
          static_cast<std::size_t>(data_[position] << 8 | data_[position + 1]);
      CheckJpeg(length >= 2 && position + length <= data_.size(),
                "it ends inside a marker segment");
      JpegSegment segment(data_.subspan(position + 2, length - 2));
      position += length;
      if (!header_.Read(marker, segment)) return false;
      if (marker == kJpegScan) position = ReadScan(position);
    }
    CheckJpeg(header_.num_scans > 0, "it holds no image data");
    return true;
  }

 private:
  /// Markers follow each other without a gap, but for fill bytes.
  std::size_t FindMarker(std::size_t position) const {
    CheckJpeg(position < data_.size() && data_[position] == 0xff, "bytes between the segments");
    while (position < data_.size() && data_[position] == 0xff) ++position;
    CheckJpeg(position < data_.size(), "no EOI at its end");
    return position;
  }

  /// Reads all segments between restart markers; returns the position of the marker that follows.
  std::size_t ReadScan(std::size_t position) {
    const bool is_interleaved = header_.scan.size() > 1;
    const int mcus_wide = is_interleaved
                              ? (header_.width + 8 * header_.max_h - 1) / (8 * header_.max_h)
                              : header_.scan[0]->blocks_wide;
    const int mcus_high = is_interleaved
                              ? (header_.height + 8 * header_.max_v - 1) / (8 * header_.max_v)
                              : header_.scan[0]->blocks_high;
    const std::int64_t num_mcus = std::int64_t{mcus_wide} * mcus_high;
    const std::int64_t interval =
        header_.restart_interval > 0 ? header_.restart_interval : num_mcus;
    for (std::int64_t first = 0, restart = 0; first < num_mcus; first += interval, ++restart) {
      position = Unstuff(position);
      for (JpegComponent* component : header_.scan) component->previous_dc = 0;
      JpegBits bits(segment_);
      const std::int64_t end = std::min(first + interval, num_mcus);
      for (std::int64_t mcu = first; mcu < end; ++mcu) {
        ReadMcu(bits, is_interleaved);
        CheckJpeg(!bits.IsOverrun(), "the image data end early");
      }
      CheckJpeg(bits.IsAtPaddedEnd(), "the image data end late");
      if (end == num_mcus) break;
      const std::size_t marker = FindMarker(position);
      CheckJpeg(data_[marker] == kRst0 + restart % 8, "restart markers out of order");
      position = marker + 1;
    }
    return position;
  }

  /// Fills segment_ with the data up to the next marker, without stuffed zeros; returns where the
  /// marker begins.
  std::size_t Unstuff(std::size_t position) {
    segment_.clear();
    while (true) {
      const auto* begin = data_.data() + position;
      const auto* found =
          static_cast<const std::uint8_t*>(std::memchr(begin, 0xff, data_.size() - position));
      CheckJpeg(found != nullptr && found + 1 < data_.data() + data_.size(), "no EOI at its end");
      segment_.insert(segment_.end(), begin, found);
      position = static_cast<std::size_t>(found - data_.data());
      if (found[1] != 0) return position;
      segment_.push_back(0xff);
      position += 2;
    }
  }

  void ReadMcu(JpegBits& bits, bool is_interleaved) {
    for (JpegComponent* component : header_.scan) {
      const int num_blocks = is_interleaved ? component->h * component->v : 1;
      for (int i = 0; i < num_blocks; ++i) bits = ReadBlock(bits, *component);
    }
  }

  /// Takes and returns the bits by value, so that they stay in registers.
  JpegBits ReadBlock(JpegBits bits, JpegComponent& component) {
    const auto& steps = header_.quantization[static_cast<std::size_t>(component.quantization)];
    const int size =
        ReadSymbol(bits, header_.dc_tables[static_cast<std::size_t>(component.dc_table)]);
    CheckJpeg(size <= 11, "a brightness out of range");
    component.previous_dc += ReadMagnitude(bits, size);
    CheckRange(component.previous_dc, steps[0]);
    const int dc = component.previous_dc * steps[0];
    std::int64_t energy = std::int64_t{dc} * dc;
    const JpegHuffmanTable& table = header_.ac_tables[static_cast<std::size_t>(component.ac_table)];
    for (int k = 1; k < 64; ++k) {
      const int symbol = ReadSymbol(bits, table);
      const int run = symbol >> 4, bits_of_value = symbol & 15;
      if (bits_of_value == 0) {
        if (run != 15) {
          CheckJpeg(run == 0, "an unknown code");
          break;
        }
        k += 15;
        CheckJpeg(k < 64, "a run beyond its block");
        continue;
      }
      k += run;
      CheckJpeg(k < 64, "a run beyond its block");
      CheckJpeg(bits_of_value <= 10, "a coefficient out of range");
      const int step = steps[static_cast<std::size_t>(k)],
                value = ReadMagnitude(bits, bits_of_value);
      CheckRange(value, step);
      energy += std::int64_t{value * step} * (value * step);
    }
    CheckEnergy(energy);
    return bits;
  }

  /// By Parseval's theorem 64 samples of at most 128 have coefficients whose squares sum up to at
  /// most 1024^2. Rounding adds up to half a step to each.
  static void CheckEnergy(std::int64_t energy) {
    CheckJpeg(energy <= kMaxEnergy, "a block brighter than white");
  }

  static int ReadSymbol(JpegBits& bits, const JpegHuffmanTable& table) {
    const JpegHuffmanTable::Symbol symbol = table.Find(bits.Peek16());
    CheckJpeg(symbol.length > 0, "an unknown code");
    bits.Skip(symbol.length);
    return symbol.value;
  }

  static int ReadMagnitude(JpegBits& bits, int size) {
    if (size == 0) return 0;
    const int value = static_cast<int>(bits.Peek16() >> (16 - size));
    bits.Skip(size);
    // Without a branch, which would be mispredicted half the time: values without their top bit are
    // negative.
    const int is_negative = (value >> (size - 1)) - 1;
    return value + (is_negative & (1 - (1 << size)));
  }

  /// No coefficient of 8-bit samples is larger than 1024, and rounding adds at most half a step.
  static void CheckRange(int value, int step) {
    CheckJpeg(std::abs(value * step) <= 1024 + step / 2 + 1, "a coefficient out of range");
  }

  std::span<const std::uint8_t> data_;
  JpegHeader header_;
  std::vector<std::uint8_t> segment_;
};

}  // namespace

JpegFinding FindJpegDamage(std::span<const std::uint8_t> data) {
  try {
    return {.is_judged = JpegChecker(data).Run(), .damage = {}};
  } catch (const JpegDamage& damage) {
    return {.is_judged = true, .damage = damage.what};
  }
}

}  // namespace parkade
