#pragma once

#include <cstdio>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/error.h"

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

/// A finding without a topic, that something is left out or doubted.
Finding WarningOf(std::string name, std::string sentence, std::string advice,
                  std::map<std::string, double> evidence);
/// The same, that no map can be made.
Finding UnusableOf(std::string name, std::string sentence, std::string advice,
                   std::map<std::string, double> evidence);

/// What printf makes of it, up to 400 characters.
template <typename... Values>
std::string FormatText(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

/// Evidence of findings about stamps: by how much they are late [s].
inline constexpr const char* kDelay = "delay_s";

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

/// A log of which no map can be made, by what was found.
class UnusableLog : public Error {
 public:
  UnusableLog(const std::string& sentence, std::vector<Finding> findings)
      : Error(ErrorCode::kInvalidInput, sentence), findings_(std::move(findings)) {}

  const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::vector<Finding> findings_;
};

/// Throws UnusableLog with the texts of those that make a log unusable, if there are any.
void RequireUsable(const std::vector<Finding>& findings);

}  // namespace parkade
