#include "server/ingest/messages/jpeg_header.h"

#include <algorithm>
#include <cstdio>
// jpeglib.h needs FILE and size_t from cstdio before it.
#include <jpeglib.h>

namespace parkade {
namespace {

constexpr std::uint8_t kSof0 = 0xc0, kSof1 = 0xc1, kSof15 = 0xcf, kDht = 0xc4, kJpg = 0xc8,
                       kDac = 0xcc, kDqt = 0xdb, kDri = 0xdd;

/// The tables of luma and chroma, for DC and AC.
struct StandardTables {
  std::array<JpegHuffmanTable, 2> dc, ac;
};

/// Those that libjpeg encodes with unless told otherwise.
StandardTables MakeStandardTables() {
  jpeg_error_mgr errors{};
  jpeg_compress_struct codec{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  codec.in_color_space = JCS_GRAYSCALE;
  codec.input_components = 1;
  jpeg_set_defaults(&codec);
  const auto build = [](const JHUFF_TBL& table, JpegHuffmanTable& built) {
    built.Build(std::span(table.bits).subspan<1, 16>(), table.huffval);
  };
  StandardTables tables;
  for (std::size_t i = 0; i < 2; ++i) {
    build(*codec.dc_huff_tbl_ptrs[i], tables.dc[i]);
    build(*codec.ac_huff_tbl_ptrs[i], tables.ac[i]);
  }
  jpeg_destroy_compress(&codec);
  return tables;
}

}  // namespace

void ReportJpegDamage(const char* what) { throw JpegDamage{what}; }

JpegHeader::JpegHeader() {
  static const StandardTables standard = MakeStandardTables();
  std::copy(standard.dc.begin(), standard.dc.end(), dc_tables.begin());
  std::copy(standard.ac.begin(), standard.ac.end(), ac_tables.begin());
}

bool JpegHeader::Read(std::uint8_t marker, JpegSegment& segment) {
  if (marker == kDht) {
    ReadHuffmanTables(segment);
  } else if (marker == kDqt) {
    ReadQuantization(segment);
  } else if (marker == kDri) {
    restart_interval = segment.Word();
  } else if (marker == kSof0 || marker == kSof1) {
    return ReadFrame(segment);
  } else if (marker == kJpegScan) {
    CheckJpeg(!components_.empty(), "a scan before its frame");
    ReadScanHeader(segment);
  } else if (marker >= kSof0 && marker <= kSof15 && marker != kJpg && marker != kDac) {
    return false;  // progressive, lossless or arithmetic
  }
  return true;
}

void JpegHeader::ReadHuffmanTables(JpegSegment& segment) {
  while (!segment.IsEmpty()) {
    const int kind = segment.Byte();
    CheckJpeg((kind & 0xef) < 4, "a wrong Huffman table");
    const auto counts = segment.Take(16);
    std::size_t total = 0;
    for (const std::uint8_t count : counts) total += count;
    JpegHuffmanTable& table =
        (kind & 0x10 ? ac_tables : dc_tables)[static_cast<std::size_t>(kind & 3)];
    CheckJpeg(table.Build(counts.first<16>(), segment.Take(total)), "a wrong Huffman table");
  }
}

void JpegHeader::ReadQuantization(JpegSegment& segment) {
  while (!segment.IsEmpty()) {
    const int kind = segment.Byte();
    CheckJpeg((kind & 0xf) < 4 && kind >> 4 <= 1, "a wrong quantization table");
    for (int& step : quantization[static_cast<std::size_t>(kind & 3)]) {
      step = kind >> 4 ? segment.Word() : segment.Byte();
      CheckJpeg(step > 0, "a wrong quantization table");
    }
  }
}

bool JpegHeader::ReadFrame(JpegSegment& segment) {
  if (segment.Byte() != 8) return false;
  height = segment.Word();
  width = segment.Word();
  if (height == 0) return false;  // set by a later DNL
  CheckJpeg(width > 0 && components_.empty(), "a wrong frame");
  components_.resize(static_cast<std::size_t>(std::clamp(segment.Byte(), 1, 4)));
  for (JpegComponent& component : components_) {
    component.id = segment.Byte();
    const int sampling = segment.Byte();
    component.h = sampling >> 4;
    component.v = sampling & 15;
    CheckJpeg(component.h >= 1 && component.h <= 4 && component.v >= 1 && component.v <= 4,
              "a wrong frame");
    max_h = std::max(max_h, component.h);
    max_v = std::max(max_v, component.v);
    component.quantization = segment.Byte() & 3;
  }
  const auto blocks = [](int size, int factor, int max_factor) {
    return (size * factor + 8 * max_factor - 1) / (8 * max_factor);
  };
  for (JpegComponent& component : components_) {
    component.blocks_wide = blocks(width, component.h, max_h);
    component.blocks_high = blocks(height, component.v, max_v);
  }
  return true;
}

void JpegHeader::ReadScanHeader(JpegSegment& segment) {
  scan.clear();
  const int count = segment.Byte();
  for (int i = 0; i < count; ++i) {
    const int id = segment.Byte(), tables = segment.Byte();
    const auto found = std::find_if(components_.begin(), components_.end(),
                                    [&](const JpegComponent& c) { return c.id == id; });
    CheckJpeg(found != components_.end() && tables >> 4 < 4 && (tables & 15) < 4,
              "a wrong scan header");
    found->dc_table = tables >> 4;
    found->ac_table = tables & 15;
    scan.push_back(&*found);
  }
  CheckJpeg(!scan.empty(), "a wrong scan header");
  // Spectral selection and approximation have one value each in a sequential scan.
  CheckJpeg(segment.Byte() == 0 && segment.Byte() == 63 && segment.Byte() == 0,
            "a wrong scan header");
  ++num_scans;
}

}  // namespace parkade
