#include "server/jobs/walls/landlock_wall.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdint>

namespace parkade {
namespace {

constexpr std::array<const char*, 3> kDevices = {"/dev/null", "/dev/zero", "/dev/full"};

// Those of later versions than the headers know.
constexpr std::uint64_t kTruncate = 1U << 14;  // version 3
constexpr std::uint64_t kChanges =             // version 2: the first that lets files move
    LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE |
    LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
    LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
    LANDLOCK_ACCESS_FS_MAKE_SYM | LANDLOCK_ACCESS_FS_REFER;

bool Allow(int rules, const char* path, std::uint64_t changes) {
  landlock_path_beneath_attr rule{};
  rule.allowed_access = changes;
  rule.parent_fd = ::open(path, O_PATH | O_CLOEXEC);
  if (rule.parent_fd < 0) return false;
  const bool is_added =
      ::syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
  ::close(rule.parent_fd);
  return is_added;
}

}  // namespace

LandlockWall::LandlockWall(const FileRules& rules) {
  for (const std::filesystem::path& folder : rules.writable) folders_.push_back(folder);
}

bool LandlockWall::Raise() const {
  const long version =
      ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 2) return false;
  const std::uint64_t changes = kChanges | (version >= 3 ? kTruncate : 0);
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = changes;
  const int rules =
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &handled, sizeof(handled), 0));
  if (rules < 0) return false;
  bool is_raised = ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
  for (const std::string& folder : folders_)
    is_raised = is_raised && Allow(rules, folder.c_str(), changes);
  for (const char* device : kDevices)
    is_raised =
        is_raised && Allow(rules, device, changes & (LANDLOCK_ACCESS_FS_WRITE_FILE | kTruncate));
  is_raised = is_raised && ::syscall(SYS_landlock_restrict_self, rules, 0) == 0;
  ::close(rules);
  return is_raised;
}

}  // namespace parkade
