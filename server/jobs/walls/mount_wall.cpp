#include "server/jobs/walls/mount_wall.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 5> kDevices = {"/dev/null", "/dev/zero", "/dev/full",
                                                 "/dev/random", "/dev/urandom"};
constexpr const char* kSockets = "/run";  // of services that a local user may talk to
constexpr std::uint64_t kHarmless = MOUNT_ATTR_NODEV | MOUNT_ATTR_NOSUID;

/// Sets attributes of a mount and, with AT_RECURSIVE, of all below; they propagate nowhere from
/// then on. Called by its number, as glibc has it since 2.36 only.
bool SetAttributes(int folder, const char* path, unsigned int flags, std::uint64_t attributes) {
  mount_attr wanted{};
  wanted.attr_set = attributes;
  wanted.propagation = MS_PRIVATE;
  return ::syscall(SYS_mount_setattr, folder, path, flags, &wanted, sizeof(wanted)) == 0;
}

bool IsBelow(const fs::path& path, const fs::path& folder) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

/// A mount of its own would keep links from being made between the two.
bool IsWithinAnother(const fs::path& path, const std::vector<fs::path>& folders) {
  const fs::path own = fs::canonical(path);
  return std::any_of(folders.begin(), folders.end(), [&](const fs::path& folder) {
    const fs::path other = fs::canonical(folder);
    return other != own && IsBelow(own, other);
  });
}

}  // namespace

MountWall::MountWall(const FileRules& rules) {
  Cover(kSockets);
  Cover(rules.hidden);
  for (const char* device : kDevices) Show(device, /*is_writable=*/true);
  for (const fs::path& path : rules.visible) Show(path, /*is_writable=*/false);
  for (const fs::path& path : rules.writable) {
    Require(fs::is_directory(path), ErrorCode::kInternal,
            "a folder that the worker is to write in is not there");
    if (!IsWithinAnother(path, rules.writable)) Show(path, /*is_writable=*/true);
  }
  // A folder that is given for both is writable.
  std::sort(shown_.begin(), shown_.end(), [](const Shown& a, const Shown& b) {
    return a.path != b.path ? a.path < b.path : a.is_writable < b.is_writable;
  });
}

void MountWall::Cover(const fs::path& folder) {
  std::error_code missing;
  const fs::path path = fs::canonical(folder, missing);
  if (!missing && path != path.root_path() && fs::is_directory(path) && !IsCovered(path))
    covered_.push_back(path);
}

bool MountWall::IsCovered(const fs::path& path) const {
  return std::any_of(covered_.begin(), covered_.end(),
                     [&](const std::string& folder) { return IsBelow(path, folder); });
}

/// What is not there cannot be shown: who looks for it says so.
void MountWall::Show(const fs::path& given, bool is_writable) {
  std::error_code missing;
  const fs::path path = fs::canonical(given, missing);
  if (missing) return;
  const fs::file_type type = fs::status(path).type();
  Shown shown{.path = path,
              .is_folder = type == fs::file_type::directory,
              .is_writable = is_writable,
              .is_device = type == fs::file_type::character};
  for (fs::path parent = path.parent_path(); IsCovered(parent); parent = parent.parent_path())
    shown.parents.insert(shown.parents.begin(), parent);
  shown_.push_back(std::move(shown));
}

bool MountWall::Raise() {
  const int before = ::open("/proc/self/ns/mnt", O_RDONLY | O_CLOEXEC);
  if (before < 0) return false;
  const bool has_own = ::unshare(CLONE_NEWNS) == 0;
  bool is_built = has_own && Build();
  // Half a wall would keep the worker from its own files.
  if (has_own && !is_built && ::setns(before, CLONE_NEWNS) != 0) ::_exit(127);
  ::close(before);
  for (const Shown& shown : shown_)
    if (shown.tree >= 0) ::close(shown.tree);
  return is_built;
}

bool MountWall::Build() {
  for (Shown& shown : shown_)
    if (!Pick(shown)) return false;
  if (!SetAttributes(AT_FDCWD, "/", AT_RECURSIVE, kHarmless | MOUNT_ATTR_RDONLY)) return false;
  for (const std::string& folder : covered_)
    if (::mount("tmpfs", folder.c_str(), "tmpfs", MS_NOSUID | MS_NODEV, "mode=0755,size=1m") != 0)
      return false;
  for (const Shown& shown : shown_)
    if (!Place(shown)) return false;
  for (const std::string& folder : covered_)
    if (!SetAttributes(AT_FDCWD, folder.c_str(), 0, kHarmless | MOUNT_ATTR_RDONLY)) return false;
  // A container may forbid it; the old one is read-only by now.
  ::mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC | MS_RDONLY, nullptr);
  return true;
}

/// Takes hold of what is to be shown, before its place is covered.
bool MountWall::Pick(Shown& shown) {
  shown.tree = static_cast<int>(::syscall(SYS_open_tree, AT_FDCWD, shown.path.c_str(),
                                          OPEN_TREE_CLONE | OPEN_TREE_CLOEXEC | AT_RECURSIVE));
  const std::uint64_t attributes = (shown.is_device ? MOUNT_ATTR_NOSUID : kHarmless) |
                                   (shown.is_writable ? 0 : MOUNT_ATTR_RDONLY);
  return shown.tree >= 0 && SetAttributes(shown.tree, "", AT_EMPTY_PATH | AT_RECURSIVE, attributes);
}

/// Where a place to mount on cannot be made, it is there, or mounting fails.
bool MountWall::Place(const Shown& shown) {
  for (const std::string& parent : shown.parents) ::mkdir(parent.c_str(), 0755);
  if (!shown.parents.empty() && shown.is_folder) ::mkdir(shown.path.c_str(), 0755);
  if (!shown.parents.empty() && !shown.is_folder)
    ::close(::open(shown.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0444));
  return ::syscall(SYS_move_mount, shown.tree, "", AT_FDCWD, shown.path.c_str(),
                   MOVE_MOUNT_F_EMPTY_PATH) == 0;
}

}  // namespace parkade
