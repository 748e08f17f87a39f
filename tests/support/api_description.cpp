#include "tests/support/api_description.h"

#include <algorithm>
#include <regex>
#include <set>
#include <vector>

#include "core/files/file.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

bool HasType(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return type == "null" && value.is_null();
}

bool HasOneOfTypes(const Json& value, const Json& types) {
  if (types.is_string()) return HasType(value, types);
  return std::any_of(types.begin(), types.end(),
                     [&](const Json& type) { return HasType(value, type); });
}

bool IsDateTime(const std::string& text) {
  static const std::regex utc(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z)");
  return std::regex_match(text, utc);
}

/// The schema and those that it is put together from.
void AddParts(const Json& schema, std::vector<const Json*>& parts) {
  parts.push_back(&schema);
  if (schema.contains("$ref")) AddParts(Resolved(schema), parts);
  if (schema.contains("allOf"))
    for (const Json& part : schema.at("allOf")) AddParts(part, parts);
}

std::string MismatchAt(const std::string& place, const Json& schema, const Json& value);

/// Members that no part of the schema names.
std::string StrangerAt(const std::string& place, const Json& schema, const Json& value) {
  std::vector<const Json*> parts;
  AddParts(schema, parts);
  const Json* of_others = nullptr;
  std::set<std::string> known;
  for (const Json* part : parts) {
    if (part->contains("properties"))
      for (const auto& property : part->at("properties").items()) known.insert(property.key());
    if (part->contains("additionalProperties")) of_others = &part->at("additionalProperties");
  }
  if (known.empty() && of_others == nullptr) return "";
  for (const auto& [name, member] : value.items()) {
    if (known.contains(name)) continue;
    if (of_others == nullptr || !of_others->is_object())
      return place + " has the member '" + name + "', which is not described";
    const std::string found = MismatchAt(place + "/" + name, *of_others, member);
    if (!found.empty()) return found;
  }
  return "";
}

std::string MismatchInObject(const std::string& place, const std::string& keyword, const Json& rule,
                             const Json& value) {
  if (keyword == "required") {
    for (const Json& name : rule)
      if (!value.contains(name.get<std::string>()))
        return place + " lacks the member " + name.dump();
  } else if (keyword == "properties") {
    for (const auto& [name, schema] : rule.items()) {
      if (!value.contains(name)) continue;
      const std::string found = MismatchAt(place + "/" + name, schema, value.at(name));
      if (!found.empty()) return found;
    }
  }
  return "";
}

std::string MismatchInArray(const std::string& place, const std::string& keyword, const Json& rule,
                            const Json& value) {
  if (keyword == "items") {
    for (size_t i = 0; i < value.size(); ++i) {
      const std::string found = MismatchAt(place + "/" + std::to_string(i), rule, value[i]);
      if (!found.empty()) return found;
    }
    return "";
  }
  const size_t bound = rule.get<size_t>();
  const bool fits = keyword == "minItems" ? value.size() >= bound : value.size() <= bound;
  return fits ? "" : place + " has " + std::to_string(value.size()) + " items";
}

bool FitsText(const std::string& keyword, const Json& rule, const std::string& text) {
  if (keyword == "maxLength") return text.size() <= rule.get<size_t>();
  if (keyword == "format") return rule != "date-time" || IsDateTime(text);
  return std::regex_search(text, std::regex(rule.get<std::string>()));
}

bool FitsNumber(const std::string& keyword, const Json& rule, double number) {
  return keyword == "minimum" ? number >= rule.get<double>() : number <= rule.get<double>();
}

/// What one keyword of a schema has against the value.
std::string MismatchWithKeyword(const std::string& place, const std::string& keyword,
                                const Json& rule, const Json& value) {
  static const std::set<std::string> of_objects = {"required", "properties"},
                                     of_arrays = {"items", "minItems", "maxItems"},
                                     of_texts = {"pattern", "maxLength", "format"},
                                     of_numbers = {"minimum", "maximum"},
                                     of_people = {"description", "examples", "default",
                                                  "additionalProperties"};
  const auto unless = [&](bool fits) {
    return fits ? "" : place + " is " + value.dump() + ", against " + keyword + " " + rule.dump();
  };
  if (of_people.contains(keyword)) return "";
  if (of_objects.contains(keyword))
    return value.is_object() ? MismatchInObject(place, keyword, rule, value) : "";
  if (of_arrays.contains(keyword))
    return value.is_array() ? MismatchInArray(place, keyword, rule, value) : "";
  if (of_texts.contains(keyword))
    return unless(!value.is_string() || FitsText(keyword, rule, value));
  if (of_numbers.contains(keyword))
    return unless(!value.is_number() || FitsNumber(keyword, rule, value));
  if (keyword == "type") return unless(HasOneOfTypes(value, rule));
  if (keyword == "enum") return unless(std::count(rule.begin(), rule.end(), value) == 1);
  if (keyword == "const") return unless(value == rule);
  if (keyword == "oneOf")
    return unless(std::count_if(rule.begin(), rule.end(), [&](const Json& schema) {
                    return MismatchAt(place, schema, value).empty();
                  }) == 1);
  return place + ": nobody looks at the keyword '" + keyword + "'";
}

std::string MismatchAt(const std::string& place, const Json& schema, const Json& value) {
  std::vector<const Json*> parts;
  AddParts(schema, parts);
  for (const Json* part : parts)
    for (const auto& [keyword, rule] : part->items()) {
      if (keyword == "$ref" || keyword == "allOf") continue;
      const std::string found = MismatchWithKeyword(place, keyword, rule, value);
      if (!found.empty()) return found;
    }
  return value.is_object() ? StrangerAt(place, schema, value) : "";
}

}  // namespace

const Json& ApiDescription() {
  static const Json description = Json::parse(ReadFile(OPENAPI_JSON));
  return description;
}

const Json& Resolved(const Json& json) {
  if (!json.contains("$ref")) return json;
  return ApiDescription().at(Json::json_pointer(json.at("$ref").get<std::string>().substr(1)));
}

std::string MismatchWith(const Json& schema, const Json& value) {
  return MismatchAt("", schema, value);
}

std::string MismatchWith(const char* name, const Json& value) {
  return MismatchWith(ApiDescription().at("components").at("schemas").at(name), value);
}

}  // namespace parkade
