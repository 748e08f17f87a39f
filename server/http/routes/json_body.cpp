#include "server/http/routes/json_body.h"

#include <algorithm>

#include "core/error.h"
#include "server/http/json_response.h"

namespace parkade {
namespace {

std::string Listed(std::initializer_list<const char*> known) {
  std::string names;
  for (const char* name : known) names += std::string(names.empty() ? "\"" : ", \"") + name + '"';
  return names;
}

/// The member, if there is one, of the kind that `is_right` tells.
const Json* Find(const Json& object, const char* key, bool (Json::*is_right)() const,
                 const char* kind) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return nullptr;
  Require((*found.*is_right)(), ErrorCode::kInvalidInput,
          std::string("\"") + key + "\" is " + kind);
  return &*found;
}

}  // namespace

Json ReadObject(const httplib::ContentReader& body, std::initializer_list<const char*> known) {
  const std::string text = ReadBody(body);
  if (text.empty()) return Json::object();
  Json object = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  Require(object.is_object(), ErrorCode::kInvalidInput,
          "the body is a JSON object with " + Listed(known));
  for (const auto& [key, value] : object.items())
    Require(std::find(known.begin(), known.end(), key) != known.end(), ErrorCode::kInvalidInput,
            "the body knows " + Listed(known) + ", not \"" + key + '"');
  return object;
}

std::optional<std::string> TextIn(const Json& object, const char* key) {
  const Json* found = Find(object, key, &Json::is_string, "a text");
  return found == nullptr ? std::nullopt : std::optional(found->get<std::string>());
}

std::optional<std::int64_t> IntegerIn(const Json& object, const char* key) {
  const Json* found = Find(object, key, &Json::is_number_integer, "a whole number");
  return found == nullptr ? std::nullopt : std::optional(found->get<std::int64_t>());
}

std::optional<bool> FlagIn(const Json& object, const char* key) {
  const Json* found = Find(object, key, &Json::is_boolean, "true or false");
  return found == nullptr ? std::nullopt : std::optional(found->get<bool>());
}

std::optional<std::vector<std::string>> TextsIn(const Json& object, const char* key) {
  const Json* found = Find(object, key, &Json::is_array, "a list of texts");
  if (found == nullptr) return std::nullopt;
  std::vector<std::string> texts;
  for (const Json& text : *found) {
    Require(text.is_string(), ErrorCode::kInvalidInput,
            std::string("\"") + key + "\" is a list of texts");
    texts.push_back(text.get<std::string>());
  }
  return texts;
}

}  // namespace parkade
