#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace parkade {

enum class Severity {
  kNote,      ///< a map is as good without
  kWarning,   ///< something of the log is left out, or doubted
  kUnusable,  ///< no map can be made
};

/// Something that is wrong with a log: it contradicts itself, its rig, or what a car can do.
/// `inspect`, the service, `map` and its report say it in the same words.
struct Finding {
  std::string name;  ///< "imu_in_g": stays the same from version to version
  Severity severity = Severity::kWarning;
  std::string topic;     ///< what it is about; may be empty
  std::string sentence;  ///< what is wrong and what it looks like, without a full stop
  std::string advice;    ///< what to do about it, alike; may be empty
  std::map<std::string, double> evidence = {};  ///< the numbers behind it, by names with units
};

/// "note", "warning", "unusable"
const char* NameOf(Severity severity);

/// "2.5 s", "10 min", "3.0 h", "20454 days"; without sign.
std::string DurationText(double seconds);

/// The sentence, and the advice behind it.
std::string ToText(const Finding& finding);

nlohmann::json ToJson(const std::vector<Finding>& findings);

/// The texts of those of a severity.
std::vector<std::string> TextsOf(const std::vector<Finding>& findings, Severity severity);

/// The texts of all that a map can be made in spite of, warnings before notes.
std::vector<std::string> WarningsOf(const std::vector<Finding>& findings);

/// Throws Error{kInvalidInput} with the texts of those that make a log unusable, if there are any.
void RequireUsable(const std::vector<Finding>& findings);

}  // namespace parkade
