#include "server/ingest/checks/finding.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

namespace parkade {

Finding WarningOf(std::string name, std::string sentence, std::string advice,
                  std::map<std::string, double> evidence) {
  return {std::move(name),     Severity::kWarning, "",
          std::move(sentence), std::move(advice),  std::move(evidence)};
}

Finding UnusableOf(std::string name, std::string sentence, std::string advice,
                   std::map<std::string, double> evidence) {
  return {std::move(name),     Severity::kUnusable, "",
          std::move(sentence), std::move(advice),   std::move(evidence)};
}

const char* NameOf(Severity severity) {
  switch (severity) {
    case Severity::kNote: return "note";
    case Severity::kWarning: return "warning";
    case Severity::kUnusable: break;
  }
  return "unusable";
}

std::string DurationText(double seconds) {
  const double size = std::abs(seconds);
  std::array<char, 40> text{};
  if (size < 100)
    std::snprintf(text.data(), text.size(), "%.3g s", size);
  else if (size < 7200)
    std::snprintf(text.data(), text.size(), "%.3g min", size / 60);
  else if (size < 172800)
    std::snprintf(text.data(), text.size(), "%.1f h", size / 3600);
  else
    std::snprintf(text.data(), text.size(), "%.0f days", size / 86400);
  return text.data();
}

std::string ToText(const Finding& finding) {
  return finding.sentence + (finding.advice.empty() ? "" : ": " + finding.advice);
}

nlohmann::json ToJson(const std::vector<Finding>& findings) {
  nlohmann::json json = nlohmann::json::array();
  for (const Finding& finding : findings)
    json.push_back({{"name", finding.name},
                    {"severity", NameOf(finding.severity)},
                    {"topic", finding.topic},
                    {"sentence", finding.sentence},
                    {"advice", finding.advice},
                    {"evidence", finding.evidence}});
  return json;
}

std::vector<std::string> TextsOf(const std::vector<Finding>& findings, Severity severity) {
  std::vector<std::string> texts;
  for (const Finding& finding : findings)
    if (finding.severity == severity) texts.push_back(ToText(finding));
  return texts;
}

std::vector<std::string> WarningsOf(const std::vector<Finding>& findings) {
  std::vector<std::string> texts = TextsOf(findings, Severity::kWarning);
  const std::vector<std::string> notes = TextsOf(findings, Severity::kNote);
  texts.insert(texts.end(), notes.begin(), notes.end());
  return texts;
}

void RequireUsable(const std::vector<Finding>& findings) {
  std::string all;
  for (const std::string& text : TextsOf(findings, Severity::kUnusable))
    all += (all.empty() ? "" : "; ") + text;
  if (!all.empty()) throw UnusableLog(all, findings);
}

}  // namespace parkade
