#include "server/store/tables/text_rules.h"

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace parkade {
namespace {

/// C0, DEL and, two bytes in UTF-8, C1.
bool HasControlCharacter(const std::string& text, bool may_have_lines) {
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool is_line = byte == '\n' || byte == '\r' || byte == '\t';
    if ((byte < 0x20 && !(is_line && may_have_lines)) || byte == 0x7f) return true;
    const bool has_next = i + 1 < text.size();
    if (byte == 0xc2 && has_next && static_cast<unsigned char>(text[i + 1]) < 0xa0) return true;
  }
  return false;
}

bool IsUtf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

bool IsBlank(const std::string& text) {
  return text.find_first_not_of(" \t\r\n") == std::string::npos;
}

}  // namespace

void CheckText(const std::string& text, const TextRule& rule) {
  const std::string name = std::string("\"") + rule.name + '"';
  Require(text.size() <= rule.max_bytes, ErrorCode::kInvalidInput,
          name + " has " + std::to_string(text.size()) + " bytes: at most " +
              std::to_string(rule.max_bytes) + " are kept");
  Require(IsUtf8(text), ErrorCode::kInvalidInput, name + " is not UTF-8");
  Require(!HasControlCharacter(text, rule.may_have_lines), ErrorCode::kInvalidInput,
          name + (rule.may_have_lines ? " has control characters"
                                      : " is one line without control characters"));
  Require(!rule.is_required || !IsBlank(text), ErrorCode::kInvalidInput, name + " is empty");
}

}  // namespace parkade
