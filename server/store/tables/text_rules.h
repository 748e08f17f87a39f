#pragma once

#include <cstddef>
#include <string>

namespace parkade {

/// What a text that people write and others read may be.
struct TextRule {
  const char* name;             ///< as the API calls it
  size_t max_bytes = 0;         ///< of UTF-8
  bool is_required = false;     ///< not empty, nor blanks alone
  bool may_have_lines = false;  ///< line breaks and tabs
};

/// Throws Error{kInvalidInput} unless `text` is UTF-8 and keeps to the rule. Control characters are
/// never taken; everything else is, markup too: it is text, and whoever shows it shows it as such.
void CheckText(const std::string& text, const TextRule& rule);

}  // namespace parkade
