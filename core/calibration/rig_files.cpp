#include "core/calibration/rig_files.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "core/error.h"

namespace parkade {
namespace {

constexpr std::string_view kExtension = ".yaml";

/// What a file may be called, the first that exists first: `name`.yaml, or with the name of a
/// recording before or behind.
struct NameOfKind {
  std::string_view name;
  bool is_whole;  ///< nothing before or behind
};

constexpr std::array kChains = {NameOfKind{"camchain-imucam", true},
                                NameOfKind{"kalibr_imucam_chain", true},
                                NameOfKind{"camchain-imucam", false}, NameOfKind{"camchain", true},
                                NameOfKind{"camchain", false}};
constexpr std::array kImus = {NameOfKind{"imu0", true}, NameOfKind{"imu", true},
                              NameOfKind{"kalibr_imu_chain", true}, NameOfKind{"imu", false}};

bool IsCalled(std::string_view file, const NameOfKind& kind) {
  if (file.starts_with('.') || !file.ends_with(kExtension)) return false;
  file.remove_suffix(kExtension.size());
  if (kind.is_whole) return file == kind.name;
  return file.ends_with("-" + std::string(kind.name)) ||
         file.starts_with(std::string(kind.name) + "-");
}

/// The only one of the names that is called so; empty where there is none.
template <typename IsCalled>
std::string OnlyOne(const std::vector<std::string>& names, const IsCalled& is_called) {
  std::vector<std::string> found;
  std::copy_if(names.begin(), names.end(), std::back_inserter(found), is_called);
  std::sort(found.begin(), found.end());
  if (found.size() > 1)
    throw Error(ErrorCode::kInvalidInput, "the rig holds several files of one kind, '" +
                                              found.front() + "' and '" + found.back() +
                                              "': keep one of them");
  return found.empty() ? "" : found.front();
}

std::string FindOne(const std::vector<std::string>& names, std::span<const NameOfKind> kinds) {
  for (const NameOfKind& kind : kinds)
    if (std::string found =
            OnlyOne(names, [&](const std::string& name) { return IsCalled(name, kind); });
        !found.empty())
      return found;
  return "";
}

bool IsOfBasalt(const std::string& name) {
  return name == kBasaltFile || (name.ends_with("_calib.json") && !name.starts_with('.'));
}

}  // namespace

RigFileNames FindRigFiles(const std::vector<std::string>& names) {
  return {FindOne(names, kChains), FindOne(names, kImus), OnlyOne(names, IsOfBasalt)};
}

}  // namespace parkade
