#include "server/store/uploads/arrived_hash.h"

#include <fstream>
#include <vector>

#include "core/error.h"

namespace parkade {

void ArrivedHash::Add(std::string_view piece) {
  sha256_.Add(piece);
  bytes_ += static_cast<std::int64_t>(piece.size());
}

bool ArrivedHash::CatchUp(const std::filesystem::path& file, std::int64_t end,
                          const std::atomic<bool>& is_stopping) {
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(first_byte_ + bytes_);
  std::vector<char> piece(size_t{1} << 20);
  while (bytes_ < end && !is_stopping) {
    const auto wanted = std::min<std::int64_t>(std::ssize(piece), end - bytes_);
    Require(static_cast<bool>(stream.read(piece.data(), wanted)), ErrorCode::kInternal,
            "an upload cannot be read back");
    Add({piece.data(), static_cast<size_t>(wanted)});
  }
  return bytes_ == end;
}

}  // namespace parkade
