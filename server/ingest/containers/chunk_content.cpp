#include "server/ingest/containers/chunk_content.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr std::uint64_t kMaxChunk = std::uint64_t{1} << 30;
constexpr std::size_t kPiece = std::size_t{256} << 10;
constexpr std::size_t kMaxWindow = kMaxMessageSize + 2 * kPiece;

UnpackingStream OpenStream(const InputFile& file, const LogRecord& chunk) {
  return {file, chunk.data_begin, chunk.data_size, chunk.compression};
}

std::string Describe(const LogRecord& chunk, const std::string& problem) {
  return "the chunk at byte " + std::to_string(chunk.begin) + " " + problem;
}

/// The fault of a chunk that unpacked to `size` bytes with `checksum`; empty: none.
std::string FindProblem(const LogRecord& chunk, UnpackingStream& stream, std::uint64_t size,
                        std::uint32_t checksum) {
  std::uint8_t one_more = 0;
  const bool is_longer = stream.Read({&one_more, 1}) > 0;
  if (stream.state() == UnpackingStream::State::kDamaged) return "has damaged compressed data";
  if (is_longer || size != chunk.unpacked_size || stream.state() != UnpackingStream::State::kEnded)
    return "does not have the size it claims";
  if (chunk.checksum && *chunk.checksum != checksum) return "has a wrong checksum";
  return "";
}

/// Reads a large chunk from front to back, keeping what was not released.
class StreamReader : public ByteReader {
 public:
  StreamReader(const InputFile& file, const LogRecord& chunk)
      : stream_(OpenStream(file, chunk)), size_(chunk.unpacked_size) {}

  std::uint64_t size() const override { return size_; }

  std::span<const std::uint8_t> Fetch(std::uint64_t offset, std::size_t count) override {
    if (offset < begin_ || offset >= size_) return {};
    const std::uint64_t skip = offset - begin_;
    while (window_.size() < skip + count && window_.size() <= kMaxWindow && Extend()) {
    }
    if (skip >= window_.size()) return {};
    const auto first = static_cast<std::size_t>(skip);
    return std::span(window_).subspan(first, std::min(count, window_.size() - first));
  }

  void Release(std::uint64_t offset) override {
    if (offset < begin_ + kPiece) return;  // it moves bytes, hence seldom
    const std::uint64_t count = std::min<std::uint64_t>(offset - begin_, window_.size());
    window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(count));
    begin_ += count;
  }

 private:
  bool Extend() {
    const std::size_t old_size = window_.size();
    window_.resize(old_size + kPiece);
    const std::size_t num_read = stream_.Read(std::span(window_).subspan(old_size));
    window_.resize(old_size + num_read);
    if (num_read < kPiece) size_ = std::min(size_, begin_ + window_.size());
    return num_read > 0;
  }

  UnpackingStream stream_;
  std::uint64_t size_;
  std::uint64_t begin_ = 0;  ///< offset of window_
  std::vector<std::uint8_t> window_;
};

/// Whether messages of a chunk with a problem are still to be trusted.
bool IsKept(const LogRecord& chunk) {
  return chunk.is_at_end || (chunk.compression == ChunkCompression::kNone && !chunk.checksum);
}

struct UnpackedBytes {
  std::vector<std::uint8_t> bytes;  ///< what came, and the rest of the piece that came last
  std::size_t num_read = 0;
};

/// At most `claimed` bytes of a stream. Memory is touched piece by piece: a chunk of few bytes that
/// claims to be large costs little.
UnpackedBytes Unpack(UnpackingStream& stream, std::uint64_t claimed) {
  UnpackedBytes unpacked;
  const auto size = static_cast<std::size_t>(std::min(claimed, kMaxHeldChunk));
  while (unpacked.num_read == unpacked.bytes.size() && unpacked.num_read < size) {
    unpacked.bytes.resize(std::min(size, unpacked.num_read + kPiece));
    unpacked.num_read += stream.Read(std::span(unpacked.bytes).subspan(unpacked.num_read));
  }
  return unpacked;
}

ChunkContent OpenSmall(const InputFile& file, const LogRecord& chunk) {
  ChunkContent content;
  UnpackingStream stream = OpenStream(file, chunk);
  UnpackedBytes unpacked = Unpack(stream, chunk.unpacked_size);
  content.bytes = std::move(unpacked.bytes);
  content.bytes.resize(unpacked.num_read);
  const std::string problem = FindProblem(chunk, stream, content.bytes.size(),
                                          chunk.checksum ? UpdateCrc32(0, content.bytes) : 0);
  if (!problem.empty()) content.problem = Describe(chunk, chunk.is_at_end ? "is cut off" : problem);
  const bool is_kept = problem.empty() || IsKept(chunk);
  if (!is_kept) content.bytes.clear();
  if (is_kept) content.reader = std::make_unique<MemoryReader>(content.bytes);
  return content;
}

/// Reads a large chunk twice: to check it, and then to use it.
ChunkContent OpenLarge(const InputFile& file, const LogRecord& chunk) {
  ChunkContent content;
  std::vector<std::uint8_t> piece(kPiece);
  UnpackingStream stream = OpenStream(file, chunk);
  std::uint64_t size = 0;
  std::uint32_t checksum = 0;
  for (std::size_t count = piece.size(); count == piece.size() && size < chunk.unpacked_size;
       size += count) {
    const std::uint64_t rest = chunk.unpacked_size - size;
    count = stream.Read(
        std::span(piece).first(static_cast<std::size_t>(std::min<std::uint64_t>(rest, kPiece))));
    checksum = UpdateCrc32(checksum, std::span(piece).first(count));
  }
  const std::string problem = FindProblem(chunk, stream, size, checksum);
  if (!problem.empty()) content.problem = Describe(chunk, chunk.is_at_end ? "is cut off" : problem);
  if (problem.empty() || IsKept(chunk))
    content.reader = std::make_unique<StreamReader>(file, chunk);
  return content;
}

}  // namespace

ChunkContent OpenChunk(const InputFile& file, const LogRecord& chunk) {
  if (chunk.unpacked_size > kMaxChunk) {
    ChunkContent content;
    content.problem = Describe(chunk, "claims to unpack to more than 1 GiB");
    return content;
  }
  return chunk.unpacked_size <= kMaxHeldChunk ? OpenSmall(file, chunk) : OpenLarge(file, chunk);
}

std::vector<std::uint8_t> UnpackDamagedChunk(const InputFile& file, const LogRecord& chunk) {
  UnpackingStream stream = OpenStream(file, chunk);
  // How much was read is not looked at: a codec that fails may have written before it noticed.
  return Unpack(stream, chunk.unpacked_size).bytes;
}

}  // namespace parkade
