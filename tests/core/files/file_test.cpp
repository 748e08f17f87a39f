#include "core/files/file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  Files() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Files() override { fs::remove_all(folder_); }

  size_t NumEntries() const {
    return static_cast<size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("files_" + std::to_string(::getpid()));
};

TEST_F(Files, ContentIsReplacedWholeAndReadBack) {
  const std::string content("a\0b\n", 4);
  WriteFileAtomically(folder_ / "f", "older and longer");
  WriteFileAtomically(folder_ / "f", content);

  EXPECT_EQ(ReadFile(folder_ / "f"), content);
  EXPECT_EQ(NumEntries(), 1U);
}

TEST_F(Files, AFailedWriterLeavesTheOldFileAndNothingElse) {
  WriteFileAtomically(folder_ / "f", "old");
  const auto write_half = [](const fs::path& temporary) {
    std::ofstream(temporary) << "half";
    throw Error(ErrorCode::kInternal, "broken");
  };

  EXPECT_THROW(WriteFileAtomically(folder_ / "f", write_half), Error);

  EXPECT_EQ(ReadFile(folder_ / "f"), "old");
  EXPECT_EQ(NumEntries(), 1U);
}

TEST_F(Files, ACopyOfAReadOnlyFileCanBeWritten) {
  WriteFileAtomically(folder_ / "published", "old");
  std::filesystem::permissions(folder_ / "published", std::filesystem::perms::owner_read);

  CopyToWrite(folder_ / "published", folder_ / "copy");

  EXPECT_EQ(ReadFile(folder_ / "copy"), "old");
  EXPECT_NE(
      std::filesystem::status(folder_ / "copy").permissions() & std::filesystem::perms::owner_write,
      std::filesystem::perms::none);
  EXPECT_THROW(CopyToWrite(folder_ / "nothing", folder_ / "copy"), Error);
}

TEST_F(Files, ReadingSaysWhatIsWrong) {
  const auto code = [&](const fs::path& file, size_t max_bytes) {
    try {
      ReadFile(file, max_bytes);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(file.filename().string()), std::string::npos);
      return error.code();
    }
    return ErrorCode::kUsage;
  };
  WriteFileAtomically(folder_ / "f", "12345");

  EXPECT_EQ(code(folder_ / "nothing", 10), ErrorCode::kNotFound);
  EXPECT_EQ(code(folder_ / "f", 4), ErrorCode::kInvalidInput);
  EXPECT_EQ(ReadFile(folder_ / "f", 5), "12345");
}

TEST_F(Files, AFolderIsNotCalledTooLarge) {
  try {
    ReadFile(folder_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    EXPECT_EQ(std::string(error.what()), "'" + folder_.string() + "' is a folder, not a file");
  }
}

TEST_F(Files, AFolderThatDoesNotExistIsAnErrorNotACrash) {
  EXPECT_THROW(WriteFileAtomically(folder_ / "no" / "f", "x"), Error);
}

}  // namespace
}  // namespace parkade
