#include "server/store/access/caller.h"

#include <algorithm>
#include <array>

namespace parkade {
namespace {

constexpr std::array kRoles = {Role::kViewer, Role::kUploader, Role::kReviewer, Role::kAdmin};

thread_local const Caller* current_caller = nullptr;

}  // namespace

const char* ToText(Role role) {
  switch (role) {
    case Role::kViewer: return "viewer";
    case Role::kUploader: return "uploader";
    case Role::kReviewer: return "reviewer";
    case Role::kAdmin: break;
  }
  return "admin";
}

std::optional<Role> RoleFromText(const std::string& text) {
  const auto found =
      std::find_if(kRoles.begin(), kRoles.end(), [&](Role role) { return text == ToText(role); });
  return found == kRoles.end() ? std::nullopt : std::optional(*found);
}

Caller CallerWithAllRights(const std::string& name) {
  Caller caller;
  caller.name = name;
  caller.role = Role::kAdmin;
  caller.may_see_pictures = true;
  caller.sites = std::nullopt;
  return caller;
}

const Caller& CurrentCaller() {
  static const Caller service = CallerWithAllRights("service");
  return current_caller == nullptr ? service : *current_caller;
}

std::optional<std::string> IdOfCurrentCaller() {
  const std::string& id = CurrentCaller().id;
  return id.empty() ? std::nullopt : std::optional(id);
}

WorkFor::WorkFor(const Caller& caller) : before_(current_caller) { current_caller = &caller; }

WorkFor::~WorkFor() { current_caller = before_; }

}  // namespace parkade
