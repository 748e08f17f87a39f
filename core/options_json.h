#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/option_about.h"

namespace parkade {

// An options struct lists its fields once:
//
//   struct MeshOptions {
//     double max_edge = 0.5;  ///< [m] effect ...
//     template <typename Visitor>
//     void VisitFields(Visitor&& visit) {
//       visit("max_edge", max_edge, OptionAbout{"Edges are at most this long.", "m", 0.01, 10});
//     }
//     void Validate() const;  ///< throws Error{kUsage}
//   };
//
// Nested option structs are fields like any other. Fields that are not visited are for the code
// only: users neither see nor set them.

template <typename T>
concept OptionStruct = requires(T options) {
  options.VisitFields([](const char*, auto&, const OptionAbout& = {""}) {});
};

/// "0.05", "inf": as short as a number can be said.
inline std::string TextOfNumber(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

/// JSON of all fields, nested structs as objects.
template <OptionStruct Options>
nlohmann::json OptionsToJson(Options options) {
  nlohmann::json json = nlohmann::json::object();
  options.VisitFields(
      [&]<typename Field>(const char* key, Field& field, const OptionAbout& = {""}) {
        if constexpr (OptionStruct<Field>) {
          json[key] = OptionsToJson(field);
        } else {
          json[key] = field;
        }
      });
  return json;
}

/// One line per option: its path, its value, its range and unit, and what it does.
template <OptionStruct Options>
std::string ExplainOptions(Options options, const std::string& path = "") {
  std::string text;
  options.VisitFields(
      [&]<typename Field>(const char* key, Field& field, const OptionAbout& about = {""}) {
        const std::string name = path + key;
        if constexpr (OptionStruct<Field>) {
          text += ExplainOptions(field, name + ".");
        } else {
          const std::string unit = *about.unit ? std::string(" ") + about.unit : "";
          text += name + " = " + nlohmann::json(field).dump() + unit;
          if (std::isfinite(about.least))
            text += " (" + TextOfNumber(about.least) + " to " + TextOfNumber(about.most) + ")";
          text += std::string("\n    ") + about.sentence + "\n";
        }
      });
  return text;
}

/// Overwrites the fields named in `json`, leaves the others. Throws
/// Error{kUsage} naming the path for an unknown key, a wrong type or a number out of its range, and
/// whatever Validate() throws.
template <OptionStruct Options>
void ReadOptionsFromJson(const nlohmann::json& json, Options& options,
                         const std::string& path = "") {
  const std::string where = path.empty() ? "the options" : "'" + path + "'";
  Require(json.is_object(), ErrorCode::kUsage, where + " must be a JSON object");
  nlohmann::json rest = json;
  options.VisitFields(
      [&]<typename Field>(const char* key, Field& field, const OptionAbout& about = {""}) {
        const auto found = rest.find(key);
        if (found == rest.end()) return;
        const std::string field_path = path.empty() ? key : path + "." + key;
        if constexpr (OptionStruct<Field>) {
          ReadOptionsFromJson(*found, field, field_path);
        } else {
          // nlohmann turns 1.7 into the int 1 and true into 1.0: refuse both.
          const nlohmann::json current = field;
          const bool is_same_kind = current.is_number_float() ? found->is_number()
                                    : current.is_number()     ? found->is_number_integer()
                                                              : found->type() == current.type();
          Require(is_same_kind, ErrorCode::kUsage,
                  "option '" + field_path + "' must be a " + std::string(current.type_name()));
          if (found->is_number()) {
            const double number = found->template get<double>();
            Require(number >= about.least && number <= about.most, ErrorCode::kUsage,
                    "option '" + field_path + "' must be from " + TextOfNumber(about.least) +
                        " to " + TextOfNumber(about.most) + (*about.unit ? " " : "") + about.unit);
          }
          field = found->template get<Field>();
        }
        rest.erase(found);
      });
  if (!rest.empty())
    throw Error(ErrorCode::kUsage,
                "unknown option '" + (path.empty() ? "" : path + ".") + rest.begin().key() + "'");
  if constexpr (requires { options.Validate(); }) options.Validate();
}

/// {"stage": {"option": value}} of "stage.option=value": the value as JSON, a bare word is a
/// string. Throws Error{kUsage}.
inline nlohmann::json ParseAssignment(const std::string& assignment) {
  const size_t equals = assignment.find('=');
  Require(equals != std::string::npos && equals > 0, ErrorCode::kUsage,
          "'" + assignment + "' is not of the form stage.option=value");
  const std::string text = assignment.substr(equals + 1);
  nlohmann::json value = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (value.is_discarded()) value = text;
  std::string path = assignment.substr(0, equals);
  for (size_t dot; (dot = path.rfind('.')) != std::string::npos; path.resize(dot))
    value = nlohmann::json{{path.substr(dot + 1), value}};
  return {{path, value}};
}

/// Applies one assignment (see ParseAssignment). Throws Error{kUsage}.
template <OptionStruct Options>
void SetOption(const std::string& assignment, Options& options) {
  ReadOptionsFromJson(ParseAssignment(assignment), options);
}

/// Applies all assignments at once, for options that are valid together only. Throws Error{kUsage}.
template <OptionStruct Options>
void SetOptions(const std::vector<std::string>& assignments, Options& options) {
  nlohmann::json all = nlohmann::json::object();
  for (const std::string& assignment : assignments) all.merge_patch(ParseAssignment(assignment));
  ReadOptionsFromJson(all, options);
}

}  // namespace parkade
