#include "server/jobs/walls/namespaces.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <string_view>

namespace parkade {
namespace {

constexpr std::array<int, 3> kOthers = {CLONE_NEWNET, CLONE_NEWPID, CLONE_NEWIPC};

void WriteTo(const char* file, std::string_view text) {
  const int fd = ::open(file, O_WRONLY | O_CLOEXEC);
  if (fd < 0) return;
  [[maybe_unused]] const ssize_t ignored = ::write(fd, text.data(), text.size());
  ::close(fd);
}

/// "ID ID 1\n": to itself. Without the C library's formatting, which may take locks.
std::string_view MapOf(unsigned int id, std::array<char, 32>& text) {
  std::array<char, 12> digits{};
  std::size_t count = 0;
  do digits[count++] = static_cast<char>('0' + id % 10);
  while ((id /= 10) > 0);
  std::size_t size = 0;
  for (int twice = 0; twice < 2; ++twice) {
    for (std::size_t i = count; i-- > 0;) text[size++] = digits[i];
    text[size++] = ' ';
  }
  text[size++] = '1';
  text[size++] = '\n';
  return {text.data(), size};
}

/// As unshare(2), within a user namespace where it takes one. Returns the flags that it did, or 0.
int Unshare(int flags) {
  if (::unshare(flags) == 0) return flags;
  const unsigned int user = ::getuid(), group = ::getgid();
  if (::unshare(CLONE_NEWUSER | flags) != 0) return 0;
  ::prctl(PR_SET_DUMPABLE, 1);  // else the files below are not ours
  std::array<char, 32> text{};
  WriteTo("/proc/self/setgroups", "deny");
  WriteTo("/proc/self/uid_map", MapOf(user, text));
  WriteTo("/proc/self/gid_map", MapOf(group, text));
  return CLONE_NEWUSER | flags;
}

}  // namespace

int LeaveOthers() {
  int all = 0;
  for (const int flag : kOthers) all |= flag;
  if (const int done = Unshare(all); done != 0) return done;
  int done = 0;
  for (const int flag : kOthers) done |= Unshare(flag);
  return done;
}

}  // namespace parkade
