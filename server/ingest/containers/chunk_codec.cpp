#include "server/ingest/containers/chunk_codec.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

constexpr std::size_t kPackedWindow = std::size_t{128} << 10;

class Lz4Unpacker : public Unpacker {
 public:
  Lz4Unpacker() {
    Require(!LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)),
            ErrorCode::kInternal, "no memory for lz4");
  }
  ~Lz4Unpacker() override { LZ4F_freeDecompressionContext(context_); }

  Step Run(std::span<const std::uint8_t> packed, std::span<std::uint8_t> out) override {
    Step step{packed.size(), out.size()};
    const std::size_t hint = LZ4F_decompress(context_, out.data(), &step.num_produced,
                                             packed.data(), &step.num_consumed, nullptr);
    Require(!LZ4F_isError(hint), ErrorCode::kInvalidInput, "damaged lz4 data");
    step.is_at_end = hint == 0;
    return step;
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

class ZstdUnpacker : public Unpacker {
 public:
  ZstdUnpacker() { Require(stream_ != nullptr, ErrorCode::kInternal, "no memory for zstd"); }
  ~ZstdUnpacker() override { ZSTD_freeDStream(stream_); }

  Step Run(std::span<const std::uint8_t> packed, std::span<std::uint8_t> out) override {
    ZSTD_inBuffer input{packed.data(), packed.size(), 0};
    ZSTD_outBuffer output{out.data(), out.size(), 0};
    const std::size_t hint = ZSTD_decompressStream(stream_, &output, &input);
    Require(!ZSTD_isError(hint), ErrorCode::kInvalidInput, "damaged zstd data");
    return {input.pos, output.pos, hint == 0};
  }

 private:
  ZSTD_DStream* stream_ = ZSTD_createDStream();
};

class Bz2Unpacker : public Unpacker {
 public:
  Bz2Unpacker() {
    Require(BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK, ErrorCode::kInternal,
            "no memory for bzip2");
  }
  ~Bz2Unpacker() override { BZ2_bzDecompressEnd(&stream_); }

  Step Run(std::span<const std::uint8_t> packed, std::span<std::uint8_t> out) override {
    if (is_at_end_) return {packed.size(), 0, true};  // bytes behind the stream are padding
    // bzlib takes no const, and does not write there.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
    stream_.avail_in = static_cast<unsigned>(packed.size());
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = static_cast<unsigned>(std::min<std::size_t>(out.size(), 1u << 30));
    const unsigned room = stream_.avail_out;
    const int result = BZ2_bzDecompress(&stream_);
    Require(result == BZ_OK || result == BZ_STREAM_END, ErrorCode::kInvalidInput,
            "damaged bzip2 data");
    is_at_end_ = result == BZ_STREAM_END;
    return {packed.size() - stream_.avail_in, room - stream_.avail_out, is_at_end_};
  }

 private:
  bz_stream stream_{};
  bool is_at_end_ = false;
};

}  // namespace

std::optional<ChunkCompression> CompressionNamed(std::string_view name) {
  if (name.empty() || name == "none") return ChunkCompression::kNone;
  if (name == "lz4") return ChunkCompression::kLz4;
  if (name == "zstd") return ChunkCompression::kZstd;
  if (name == "bz2") return ChunkCompression::kBz2;
  return std::nullopt;
}

std::unique_ptr<Unpacker> MakeUnpacker(ChunkCompression compression) {
  switch (compression) {
    case ChunkCompression::kNone: break;
    case ChunkCompression::kLz4: return std::make_unique<Lz4Unpacker>();
    case ChunkCompression::kZstd: return std::make_unique<ZstdUnpacker>();
    case ChunkCompression::kBz2: return std::make_unique<Bz2Unpacker>();
  }
  return nullptr;
}

UnpackingStream::UnpackingStream(const InputFile& file, std::uint64_t begin, std::uint64_t size,
                                 ChunkCompression compression)
    : file_(&file), next_(begin), end_(begin + size), unpacker_(MakeUnpacker(compression)) {}

std::size_t UnpackingStream::Read(std::span<std::uint8_t> out) {
  if (!unpacker_) return ReadPlain(out);
  std::size_t num_read = 0;
  while (num_read < out.size() && state_ == State::kRunning) {
    const bool is_input_over = rest_.empty() && !Refill();
    if (is_input_over && !is_in_frame_) {
      state_ = State::kEnded;
      break;
    }
    try {
      // Runs even without input: the unpacker may still hold output.
      const Unpacker::Step step = unpacker_->Run(rest_, out.subspan(num_read));
      rest_ = rest_.subspan(step.num_consumed);
      num_read += step.num_produced;
      is_in_frame_ = !step.is_at_end;
      if (step.num_consumed + step.num_produced == 0)
        state_ = is_input_over ? State::kCut : State::kDamaged;
    } catch (const Error&) {
      state_ = State::kDamaged;
    }
  }
  return num_read;
}

std::size_t UnpackingStream::ReadPlain(std::span<std::uint8_t> out) {
  const std::size_t asked =
      static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), end_ - next_));
  const std::size_t num_read = file_->ReadAt(next_, out.first(asked));
  next_ += num_read;
  if (num_read < asked) state_ = State::kCut;
  if (num_read == asked && next_ == end_) state_ = State::kEnded;
  return num_read;
}

bool UnpackingStream::Refill() {
  packed_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kPackedWindow, end_ - next_)));
  packed_.resize(file_->ReadAt(next_, packed_));
  next_ += packed_.size();
  rest_ = packed_;
  return !packed_.empty();
}

std::vector<std::uint8_t> UnpackZstd(std::span<const std::uint8_t> packed, std::size_t max_size) {
  const unsigned long long claimed = ZSTD_getFrameContentSize(packed.data(), packed.size());
  const bool is_known = claimed != ZSTD_CONTENTSIZE_ERROR && claimed != ZSTD_CONTENTSIZE_UNKNOWN;
  const unsigned long long guess = is_known ? claimed : 4 * packed.size();
  std::vector<std::uint8_t> out(
      static_cast<std::size_t>(std::min<unsigned long long>(guess, max_size)));
  ZstdUnpacker unpacker;
  for (std::size_t size = 0;;) {
    if (size == out.size()) {
      Require(size < max_size, ErrorCode::kInvalidInput, "a packed message is too large");
      out.resize(std::min(2 * size + 1024, max_size));
    }
    const Unpacker::Step step = unpacker.Run(packed, std::span(out).subspan(size));
    packed = packed.subspan(step.num_consumed);
    size += step.num_produced;
    if (step.is_at_end && packed.empty()) {
      out.resize(size);
      return out;
    }
    Require(step.num_consumed + step.num_produced > 0, ErrorCode::kInvalidInput,
            "a packed message is cut off");
  }
}

bool IsZstd(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 4> kMagic = {0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

std::uint32_t UpdateCrc32(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

}  // namespace parkade
