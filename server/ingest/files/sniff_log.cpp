#include "server/ingest/files/sniff_log.h"

#include <array>
#include <fstream>
#include <string>
#include <string_view>

#include "core/error.h"

namespace parkade {
namespace {

struct Magic {
  size_t offset;
  std::string_view bytes;
};

using namespace std::string_view_literals;

constexpr std::array kMagics = {
    Magic{0, "#ROSBAG V2.0"sv},       // ROS 1 bag
    Magic{0, "\x89MCAP0\r\n"sv},      // MCAP
    Magic{0, "SQLite format 3\0"sv},  // rosbag2
    Magic{0, "\x28\xB5\x2F\xFD"sv},   // zstd: rosbag2 or tar
    Magic{0, "\x1F\x8B"sv},           // gzip: tar
    Magic{0, "PK\x03\x04"sv},         // zip
    Magic{257, "ustar"sv},            // tar
};

}  // namespace

void CheckLooksLikeLog(const std::filesystem::path& file) {
  std::array<char, 512> block{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(block.data(), block.size());
  const std::string_view begin(block.data(), static_cast<size_t>(stream.gcount()));
  for (const Magic& magic : kMagics)
    if (begin.size() > magic.offset && begin.substr(magic.offset).starts_with(magic.bytes)) return;
  throw Error(ErrorCode::kInvalidInput,
              "this is no drive log: not a ROS 1 bag, MCAP, rosbag2 file, nor an archive of a "
              "drive's folder");
}

}  // namespace parkade
