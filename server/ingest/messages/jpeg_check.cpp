#include "server/ingest/messages/jpeg_check.h"

#include <algorithm>
#include <cstring>

#include "server/ingest/messages/jpeg_bits.h"

namespace parkade {
namespace {

constexpr std::int64_t kMaxEnergy = 1200 * 1200;

constexpr std::uint8_t kSof0 = 0xc0, kSof1 = 0xc1, kSof15 = 0xcf, kDht = 0xc4, kJpg = 0xc8,
                       kDac = 0xcc;
constexpr std::uint8_t kRst0 = 0xd0, kRst7 = 0xd7, kSoi = 0xd8, kEoi = 0xd9, kSos = 0xda,
                       kDqt = 0xdb, kDri = 0xdd;

struct Component {
  int id = 0, h = 1, v = 1;
  int quantization = 0, dc_table = 0, ac_table = 0;
  int previous_dc = 0;
  int blocks_wide = 0, blocks_high = 0;  ///< of a scan of this component alone
};

struct Damage {
  std::string what;
};

[[noreturn]] __attribute__((noinline, cold)) void Report(const char* what) { throw Damage{what}; }

inline void Check(bool is_fine, const char* what) {
  if (!is_fine) Report(what);
}

/// Reads marker segments, checking every length.
class Segment {
 public:
  explicit Segment(std::span<const std::uint8_t> data) : data_(data) {}
  bool IsEmpty() const { return data_.empty(); }
  std::span<const std::uint8_t> Take(std::size_t size) {
    Check(size <= data_.size(), "a marker segment is too short");
    const auto taken = data_.first(size);
    data_ = data_.subspan(size);
    return taken;
  }
  int Byte() { return Take(1)[0]; }
  int Word() {
    const auto bytes = Take(2);
    return bytes[0] << 8 | bytes[1];
  }

 private:
  std::span<const std::uint8_t> data_;
};

class JpegChecker {
 public:
  explicit JpegChecker(std::span<const std::uint8_t> data) : data_(data) {}

  void Run() {
    std::size_t position = 2;  // behind SOI
    while (true) {
      position = FindMarker(position);
      const std::uint8_t marker = data_[position++];
      if (marker == kEoi) break;
      if (marker == kSoi || (marker >= kRst0 && marker <= kRst7))
        Report("a marker at a wrong place");
      Check(position + 2 <= data_.size(), "it ends inside a marker segment");
      const std::size_t length =
          static_cast<std::size_t>(data_[position] << 8 | data_[position + 1]);
      Check(length >= 2 && position + length <= data_.size(), "it ends inside a marker segment");
      Segment segment(data_.subspan(position + 2, length - 2));
      position += length;
      if (!ReadSegment(marker, segment)) return;
      if (marker == kSos) position = ReadScan(position);
    }
    Check(num_scans_ > 0, "it holds no image data");
  }

 private:
  /// Markers follow each other without a gap, but for fill bytes.
  std::size_t FindMarker(std::size_t position) const {
    Check(position < data_.size() && data_[position] == 0xff, "bytes between the segments");
    while (position < data_.size() && data_[position] == 0xff) ++position;
    Check(position < data_.size(), "no EOI at its end");
    return position;
  }

  /// False when the file is of a kind that is not checked.
  bool ReadSegment(std::uint8_t marker, Segment& segment) {
    if (marker == kDht) {
      ReadHuffmanTables(segment);
    } else if (marker == kDqt) {
      ReadQuantization(segment);
    } else if (marker == kDri) {
      restart_interval_ = segment.Word();
    } else if (marker == kSof0 || marker == kSof1) {
      return ReadFrame(segment);
    } else if (marker == kSos) {
      Check(!components_.empty(), "a scan before its frame");
      if (!has_huffman_tables_) return false;  // motion JPEG, which leaves out the standard tables
      ReadScanHeader(segment);
    } else if (marker >= kSof0 && marker <= kSof15 && marker != kJpg && marker != kDac) {
      return false;  // progressive, lossless or arithmetic
    }
    return true;
  }

  void ReadHuffmanTables(Segment& segment) {
    has_huffman_tables_ = true;
    while (!segment.IsEmpty()) {
      const int kind = segment.Byte();
      Check((kind & 0xef) < 4, "a wrong Huffman table");
      const auto counts = segment.Take(16);
      std::size_t total = 0;
      for (const std::uint8_t count : counts) total += count;
      JpegHuffmanTable& table =
          (kind & 0x10 ? ac_tables_ : dc_tables_)[static_cast<std::size_t>(kind & 3)];
      Check(table.Build(counts.first<16>(), segment.Take(total)), "a wrong Huffman table");
    }
  }

  void ReadQuantization(Segment& segment) {
    while (!segment.IsEmpty()) {
      const int kind = segment.Byte();
      Check((kind & 0xf) < 4 && kind >> 4 <= 1, "a wrong quantization table");
      for (int& step : quantization_[static_cast<std::size_t>(kind & 3)]) {
        step = kind >> 4 ? segment.Word() : segment.Byte();
        Check(step > 0, "a wrong quantization table");
      }
    }
  }

  bool ReadFrame(Segment& segment) {
    if (segment.Byte() != 8) return false;
    height_ = segment.Word();
    width_ = segment.Word();
    if (height_ == 0) return false;  // set by a later DNL
    Check(width_ > 0 && components_.empty(), "a wrong frame");
    components_.resize(static_cast<std::size_t>(std::clamp(segment.Byte(), 1, 4)));
    for (Component& component : components_) {
      component.id = segment.Byte();
      const int sampling = segment.Byte();
      component.h = sampling >> 4;
      component.v = sampling & 15;
      Check(component.h >= 1 && component.h <= 4 && component.v >= 1 && component.v <= 4,
            "a wrong frame");
      max_h_ = std::max(max_h_, component.h);
      max_v_ = std::max(max_v_, component.v);
      component.quantization = segment.Byte() & 3;
    }
    const auto blocks = [](int size, int factor, int max_factor) {
      return (size * factor + 8 * max_factor - 1) / (8 * max_factor);
    };
    for (Component& component : components_) {
      component.blocks_wide = blocks(width_, component.h, max_h_);
      component.blocks_high = blocks(height_, component.v, max_v_);
    }
    return true;
  }

  void ReadScanHeader(Segment& segment) {
    scan_.clear();
    const int count = segment.Byte();
    for (int i = 0; i < count; ++i) {
      const int id = segment.Byte(), tables = segment.Byte();
      const auto found = std::find_if(components_.begin(), components_.end(),
                                      [&](const Component& c) { return c.id == id; });
      Check(found != components_.end() && tables >> 4 < 4 && (tables & 15) < 4,
            "a wrong scan header");
      found->dc_table = tables >> 4;
      found->ac_table = tables & 15;
      scan_.push_back(&*found);
    }
    Check(!scan_.empty(), "a wrong scan header");
    // Spectral selection and approximation have one value each in a sequential scan.
    Check(segment.Byte() == 0 && segment.Byte() == 63 && segment.Byte() == 0,
          "a wrong scan header");
    ++num_scans_;
  }

  /// Reads all segments between restart markers; returns the position of the marker that follows.
  std::size_t ReadScan(std::size_t position) {
    const bool is_interleaved = scan_.size() > 1;
    const int mcus_wide =
        is_interleaved ? (width_ + 8 * max_h_ - 1) / (8 * max_h_) : scan_[0]->blocks_wide;
    const int mcus_high =
        is_interleaved ? (height_ + 8 * max_v_ - 1) / (8 * max_v_) : scan_[0]->blocks_high;
    const std::int64_t num_mcus = std::int64_t{mcus_wide} * mcus_high;
    const std::int64_t interval = restart_interval_ > 0 ? restart_interval_ : num_mcus;
    for (std::int64_t first = 0, restart = 0; first < num_mcus; first += interval, ++restart) {
      position = Unstuff(position);
      for (Component* component : scan_) component->previous_dc = 0;
      JpegBits bits(segment_);
      const std::int64_t end = std::min(first + interval, num_mcus);
      for (std::int64_t mcu = first; mcu < end; ++mcu) {
        ReadMcu(bits, is_interleaved);
        Check(!bits.IsOverrun(), "the image data end early");
      }
      Check(bits.IsAtPaddedEnd(), "the image data end late");
      if (end == num_mcus) break;
      const std::size_t marker = FindMarker(position);
      Check(data_[marker] == kRst0 + restart % 8, "restart markers out of order");
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
      Check(found != nullptr && found + 1 < data_.data() + data_.size(), "no EOI at its end");
      segment_.insert(segment_.end(), begin, found);
      position = static_cast<std::size_t>(found - data_.data());
      if (found[1] != 0) return position;
      segment_.push_back(0xff);
      position += 2;
    }
  }

  void ReadMcu(JpegBits& bits, bool is_interleaved) {
    for (Component* component : scan_) {
      const int num_blocks = is_interleaved ? component->h * component->v : 1;
      for (int i = 0; i < num_blocks; ++i) bits = ReadBlock(bits, *component);
    }
  }

  /// Takes and returns the bits by value, so that they stay in registers.
  JpegBits ReadBlock(JpegBits bits, Component& component) {
    const auto& steps = quantization_[static_cast<std::size_t>(component.quantization)];
    const int size = ReadSymbol(bits, dc_tables_[static_cast<std::size_t>(component.dc_table)]);
    Check(size <= 11, "a brightness out of range");
    component.previous_dc += ReadMagnitude(bits, size);
    CheckRange(component.previous_dc, steps[0]);
    const int dc = component.previous_dc * steps[0];
    std::int64_t energy = std::int64_t{dc} * dc;
    const JpegHuffmanTable& table = ac_tables_[static_cast<std::size_t>(component.ac_table)];
    for (int k = 1; k < 64; ++k) {
      const int symbol = ReadSymbol(bits, table);
      const int run = symbol >> 4, bits_of_value = symbol & 15;
      if (bits_of_value == 0) {
        if (run != 15) {
          Check(run == 0, "an unknown code");
          break;
        }
        k += 15;
        Check(k < 64, "a run beyond its block");
        continue;
      }
      k += run;
      Check(k < 64, "a run beyond its block");
      Check(bits_of_value <= 10, "a coefficient out of range");
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
    Check(energy <= kMaxEnergy, "a block brighter than white");
  }

  static int ReadSymbol(JpegBits& bits, const JpegHuffmanTable& table) {
    const JpegHuffmanTable::Symbol symbol = table.Find(bits.Peek16());
    Check(symbol.length > 0, "an unknown code");
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
    Check(std::abs(value * step) <= 1024 + step / 2 + 1, "a coefficient out of range");
  }

  std::span<const std::uint8_t> data_;
  std::array<JpegHuffmanTable, 4> dc_tables_, ac_tables_;
  std::array<std::array<int, 64>, 4> quantization_{};
  std::vector<Component> components_;
  std::vector<Component*> scan_;
  std::vector<std::uint8_t> segment_;
  bool has_huffman_tables_ = false;
  int width_ = 0, height_ = 0, max_h_ = 1, max_v_ = 1, restart_interval_ = 0, num_scans_ = 0;
};

}  // namespace

std::optional<std::string> FindJpegDamage(std::span<const std::uint8_t> data) {
  try {
    JpegChecker(data).Run();
  } catch (const Damage& damage) {
    return damage.what;
  }
  return std::nullopt;
}

}  // namespace parkade
