#include "server/jobs/walls/rights.h"

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>

namespace parkade {
namespace {

constexpr int kKept = CAP_DAC_OVERRIDE;

}  // namespace

void DropRights() {
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  // The kernel says how many it knows by refusing the next.
  for (int right = 0; ::prctl(PR_CAPBSET_READ, right, 0, 0, 0) >= 0; ++right)
    if (right != kKept) ::prctl(PR_CAPBSET_DROP, right, 0, 0, 0);
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> rights{};
  if (::syscall(SYS_capget, &header, rights.data()) != 0) return;
  const __u32 kept = rights[0].permitted & (1U << kKept);
  rights = {};
  rights[0].permitted = rights[0].effective = kept;
  ::syscall(SYS_capset, &header, rights.data());
}

}  // namespace parkade
