#include "core/files/appended_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// Bytes that show where they come from.
std::string Bytes(std::size_t size, std::size_t begin) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<char>(((begin + i) * 2654435761u) >> 13);
  return bytes;
}

/// Appends in pieces of all sizes, some larger than the buffer, and reads across all borders.
void ExpectReadsWhatWasAppended(AppendedFile& file) {
  std::size_t size = 0;
  for (const std::size_t piece :
       {std::size_t{1}, std::size_t{100'000}, AppendedFile::kBufferBytes,
        3 * AppendedFile::kBufferBytes + 5, std::size_t{7}, std::size_t{200'000}}) {
    file.Append(Bytes(piece, size));
    size += piece;
    ASSERT_EQ(file.size(), size);
    for (const std::size_t begin : {std::size_t{0}, size / 3, size - piece, size - 1})
      for (const std::size_t count : {size - begin, (size - begin) / 2, std::size_t{1}})
        ASSERT_EQ(file.Read(begin, count), Bytes(count, begin)) << begin << " of " << size;
  }
  EXPECT_EQ(file.Read(size, 0), "");
}

TEST(AppendedFile, IsReadAnywhereWhileItGrows) {
  AppendedFile file;
  ExpectReadsWhatWasAppended(file);
}

TEST(AppendedFile, WithoutAFolderItIsInMemory) {
  const char* before = std::getenv("TMPDIR");
  const std::string restored = before ? before : "";
  ::setenv("TMPDIR", "/nowhere/at/all", 1);
  AppendedFile file;
  ExpectReadsWhatWasAppended(file);
  before ? ::setenv("TMPDIR", restored.c_str(), 1) : ::unsetenv("TMPDIR");
}

TEST(AppendedFile, AFileWithANameStaysAsItWasFlushed) {
  const fs::path path = fs::path(testing::TempDir()) / ("appended_" + std::to_string(::getpid()));
  {
    AppendedFile file(path);
    file.Append("head????");
    file.Append(Bytes(1'000'000, 8));
    file.Overwrite(4, "ends");
    file.Append("tail");
    file.Flush();
    EXPECT_THROW(AppendedFile{path}, Error) << "it is there already";
  }
  EXPECT_EQ(ReadFile(path), "headends" + Bytes(1'000'000, 8) + "tail");
  fs::remove(path);
  EXPECT_THROW(AppendedFile{path / "nowhere"}, Error);
}

}  // namespace
}  // namespace parkade
