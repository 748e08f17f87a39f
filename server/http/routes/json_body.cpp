#include "server/http/routes/json_body.h"

#include <algorithm>

#include "core/error.h"
#include "core/files/foreign_json.h"
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

void RequireObject(const Json& value, const std::string& name,
                   std::initializer_list<const char*> known) {
  Require(value.is_object(), ErrorCode::kInvalidInput,
          name + " is a JSON object with " + Listed(known));
  for (const auto& item : value.items())
    Require(std::find(known.begin(), known.end(), item.key()) != known.end(),
            ErrorCode::kInvalidInput,
            name + " knows " + Listed(known) + ", not \"" + item.key() + '"');
}

Json ReadObject(const httplib::ContentReader& body, std::initializer_list<const char*> known,
                size_t max_bytes) {
  const std::string text = ReadBody(body, max_bytes);
  if (text.empty()) return Json::object();
  Json object = ParseForeignJson(text);
  RequireObject(object, "the body", known);
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

std::optional<double> RealIn(const Json& object, const char* key) {
  const Json* found = Find(object, key, &Json::is_number, "a number");
  return found == nullptr ? std::nullopt : std::optional(found->get<double>());
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

std::array<double, 3> PointOf(const Json& value) {
  const bool is_point = value.is_array() && value.size() == 3 &&
                        std::all_of(value.begin(), value.end(),
                                    [](const Json& number) { return number.is_number(); });
  Require(is_point, ErrorCode::kInvalidInput, "a point is a list of three numbers, [x, y, z]");
  return value.get<std::array<double, 3>>();
}

}  // namespace parkade
