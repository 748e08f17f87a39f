#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/ingest/messages/jpeg_bits.h"

namespace parkade {

/// The marker of a scan.
inline constexpr std::uint8_t kJpegScan = 0xda;

/// Thrown inside the check of a JPEG; what is wrong with it.
struct JpegDamage {
  std::string what;
};

[[noreturn]] __attribute__((cold)) void ReportJpegDamage(const char* what);

inline void CheckJpeg(bool is_fine, const char* what) {
  if (!is_fine) ReportJpegDamage(what);
}

/// Reads marker segments, checking every length.
class JpegSegment {
 public:
  explicit JpegSegment(std::span<const std::uint8_t> data) : data_(data) {}
  bool IsEmpty() const { return data_.empty(); }
  std::span<const std::uint8_t> Take(std::size_t size) {
    CheckJpeg(size <= data_.size(), "a marker segment is too short");
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

struct JpegComponent {
  int id = 0, h = 1, v = 1;
  int quantization = 0, dc_table = 0, ac_table = 0;
  int previous_dc = 0;
  int blocks_wide = 0, blocks_high = 0;  ///< of a scan of this component alone
};

/// The tables, the frame and the header of the latest scan of a baseline JPEG.
class JpegHeader {
 public:
  /// Begins with the Huffman tables that motion JPEG leaves out. ITU-T T.81, K.3.
  JpegHeader();

  /// Reads one marker segment. False when the file is of a kind that is not checked. Throws
  /// JpegDamage.
  bool Read(std::uint8_t marker, JpegSegment& segment);

  std::array<JpegHuffmanTable, 4> dc_tables, ac_tables;
  std::array<std::array<int, 64>, 4> quantization{};
  std::vector<JpegComponent*> scan;  ///< the components of the scan
  int width = 0, height = 0;         ///< [px]
  int max_h = 1, max_v = 1, restart_interval = 0, num_scans = 0;

 private:
  void ReadHuffmanTables(JpegSegment& segment);
  void ReadQuantization(JpegSegment& segment);
  bool ReadFrame(JpegSegment& segment);
  void ReadScanHeader(JpegSegment& segment);

  std::vector<JpegComponent> components_;
};

}  // namespace parkade
