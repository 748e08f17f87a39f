#include "core/tune_malloc.h"

#include <unistd.h>

#include <cstdlib>  // where __GLIBC__ comes from
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace parkade {
namespace {

constexpr const char* kTunables = "GLIBC_TUNABLES";
constexpr const char* kHugePages = "glibc.malloc.hugetlb";

bool AreHugePagesForWhoAsks() {
  std::string choice;
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), choice);
  return choice.find("[madvise]") != std::string::npos;
}

}  // namespace

void TuneMalloc() {
#ifdef __GLIBC__
  constexpr int kLargest =
      32 << 20;  // bytes of a piece, as much as glibc allows: larger ones are given back
  constexpr int kMostIdle = 256 << 20;  // bytes at the end of the heap
  ::mallopt(M_MMAP_THRESHOLD, kLargest);
  ::mallopt(M_TRIM_THRESHOLD, kMostIdle);
#endif
}

void UseHugePages(char* const* arguments) {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const char* const set = std::getenv(kTunables);
  std::string tunables = set ? set : "";
  if (tunables.find(kHugePages) != std::string::npos || !AreHugePagesForWhoAsks()) return;
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return;
  tunables += (tunables.empty() ? "" : ":") + std::string(kHugePages) + "=1";
  if (::setenv(kTunables, tunables.c_str(), 1) == 0) ::execv(program.c_str(), arguments);
#endif
}

void ReleaseIdleMemory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace parkade
