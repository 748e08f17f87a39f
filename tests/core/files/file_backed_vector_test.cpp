#include "core/files/file_backed_vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <string>

namespace parkade {
namespace {

constexpr std::size_t kLarge = kMinScratchBytes / sizeof(std::uint32_t) + 1000;

/// [KiB] of the line that begins with `name` in what the system says about this process.
long StatusOf(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(name)) return std::stol(line.substr(name.size() + 1));
  return -1;
}

/// The environment of a test, as it was afterwards.
class ScratchFolder {
 public:
  explicit ScratchFolder(const char* folder) {
    if (const char* before = std::getenv("TMPDIR")) before_ = before;
    ::setenv("TMPDIR", folder, 1);
  }
  ~ScratchFolder() {
    if (before_.empty())
      ::unsetenv("TMPDIR");
    else
      ::setenv("TMPDIR", before_.c_str(), 1);
  }

 private:
  std::string before_;
};

TEST(FileBackedVector, KeepsWhatIsReleased) {
  FileBackedVector<std::uint32_t> values(kLarge);
  std::iota(values.begin(), values.end(), 7U);
  const long before = StatusOf("VmRSS:");

  ReleaseMemory(values);

  EXPECT_LT(StatusOf("VmRSS:"), before - static_cast<long>(kMinScratchBytes >> 11));
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], i + 7);
}

TEST(FileBackedVector, GrowsFromMemoryIntoAFile) {
  FileBackedVector<std::uint32_t> values;
  for (std::uint32_t i = 0; i < kLarge; ++i) {
    values.push_back(i);
    if (i % 1000000 == 0) ReleaseMemory(values);
  }
  EXPECT_EQ(std::accumulate(values.begin(), values.end(), std::uint64_t{0}),
            std::uint64_t{kLarge} * (kLarge - 1) / 2);
}

TEST(FileBackedVector, WithoutAFolderItIsInMemory) {
  const ScratchFolder nowhere("/nowhere/at/all");
  FileBackedVector<std::uint32_t> values(kLarge, 3);
  ReleaseMemory(values);
  EXPECT_TRUE(
      std::all_of(values.begin(), values.end(), [](std::uint32_t value) { return value == 3; }));
}

}  // namespace
}  // namespace parkade
