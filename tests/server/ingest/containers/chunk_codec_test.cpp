#include "server/ingest/containers/chunk_codec.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

using State = UnpackingStream::State;

constexpr std::pair<ChunkCompression, LogCompression> kCodecs[] = {
    {ChunkCompression::kNone, LogCompression::kNone},
    {ChunkCompression::kLz4, LogCompression::kLz4},
    {ChunkCompression::kZstd, LogCompression::kZstd},
    {ChunkCompression::kBz2, LogCompression::kBz2},
};

std::vector<std::uint8_t> SomeBytes() {
  std::vector<std::uint8_t> bytes;
  for (const SampleMessage& message : SampleMessages())
    bytes.insert(bytes.end(), message.data.begin(), message.data.end());
  return bytes;
}

// All that comes out, in pieces of an odd size.
std::pair<std::vector<std::uint8_t>, State> UnpackAll(const std::vector<std::uint8_t>& packed,
                                                      ChunkCompression codec) {
  const ScratchFile scratch(".packed");
  scratch.Write(packed);
  const InputFile file(scratch.path());
  UnpackingStream stream(file, 0, packed.size(), codec);
  std::vector<std::uint8_t> out, piece(10'007);
  while (const std::size_t count = stream.Read(piece))
    out.insert(out.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
  return {out, stream.state()};
}

TEST(UnpackingStream, GivesBackWhatWasPacked) {
  const std::vector<std::uint8_t> bytes = SomeBytes();
  for (const auto& [codec, writer] : kCodecs) {
    const auto [out, state] = UnpackAll(Compress(bytes, writer), codec);

    EXPECT_EQ(out, bytes) << NameOf(writer);
    EXPECT_EQ(state, State::kEnded) << NameOf(writer);
  }
}

TEST(UnpackingStream, OfACutStreamGivesTheBeginningAndSaysSo) {
  const std::vector<std::uint8_t> bytes = SomeBytes();
  for (const auto& [codec, writer] : kCodecs) {
    if (codec == ChunkCompression::kNone) continue;  // has no end of its own
    std::vector<std::uint8_t> packed = Compress(bytes, writer);
    packed.resize(packed.size() / 2);
    const auto [out, state] = UnpackAll(packed, codec);

    EXPECT_EQ(state, State::kCut) << NameOf(writer);
    EXPECT_LT(out.size(), bytes.size());
    EXPECT_TRUE(std::equal(out.begin(), out.end(), bytes.begin())) << NameOf(writer);
  }
}

TEST(UnpackingStream, NoticesAFlippedBit) {
  const std::vector<std::uint8_t> bytes = SomeBytes();
  for (const auto& [codec, writer] : kCodecs) {
    if (codec != ChunkCompression::kLz4 && codec != ChunkCompression::kBz2)
      continue;  // no checksum of their own
    std::vector<std::uint8_t> packed = Compress(bytes, writer);
    packed[packed.size() / 2] ^= 4;

    EXPECT_EQ(UnpackAll(packed, codec).second, State::kDamaged) << NameOf(writer);
  }
}

TEST(UnpackZstd, RefusesWhatGrowsBeyondItsLimit) {
  const std::vector<std::uint8_t> zeros(1 << 20);
  const std::vector<std::uint8_t> packed = Compress(zeros, LogCompression::kZstd);

  EXPECT_EQ(UnpackZstd(packed, zeros.size()), zeros);
  EXPECT_THROW(UnpackZstd(packed, zeros.size() - 1), Error);
}

TEST(UnpackZstd, RefusesAFrameThatIsCutOff) {
  std::vector<std::uint8_t> packed = Compress(SomeBytes(), LogCompression::kZstd);
  packed.resize(packed.size() - 10);

  EXPECT_THROW(UnpackZstd(packed, 1 << 24), Error);
}

TEST(Crc32, IsThatOfItsStandard) {
  const std::string check = "123456789";
  EXPECT_EQ(UpdateCrc32(0, {reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}),
            0xCBF43926u);
}

}  // namespace
}  // namespace parkade
