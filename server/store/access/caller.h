#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/site_scope.h"

namespace parkade {

/// What a caller may do in all; see Right for what each route asks for.
enum class Role { kViewer, kUploader, kReviewer, kAdmin };

/// "viewer", "uploader", ...
const char* ToText(Role role);
/// Nothing for other words.
std::optional<Role> RoleFromText(const std::string& text);

/// Who asks for something, or does it by itself.
struct Caller {
  std::string id;    ///< of the token or link; empty for those who need none
  std::string name;  ///< for people: that of the token or link, "local", "service", "command line"
  Role role = Role::kViewer;
  bool may_see_pictures = false;
  bool has_link_only = false;  ///< may read maps and nothing else
  SiteScope sites = std::vector<std::string>();
  std::optional<std::int64_t> version;  ///< the only one of the site that a link leads to
  std::string address;                  ///< where the request comes from; empty where none does
};

/// Who may do all without saying who it is, and whoever does something of itself.
Caller CallerWithAllRights(const std::string& name);

/// Whoever this thread works for; "service" where no request is answered.
const Caller& CurrentCaller();

/// Its id; nothing where it needs none.
std::optional<std::string> IdOfCurrentCaller();

/// Makes this thread work for `caller` as long as it lives.
class WorkFor {
 public:
  explicit WorkFor(const Caller& caller);
  explicit WorkFor(Caller&&) = delete;  ///< it would be gone already
  ~WorkFor();
  WorkFor(const WorkFor&) = delete;
  WorkFor& operator=(const WorkFor&) = delete;

 private:
  const Caller* before_;
};

}  // namespace parkade
