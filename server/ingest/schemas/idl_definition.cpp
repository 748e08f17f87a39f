#include "server/ingest/schemas/idl_definition.h"

#include <charconv>
#include <string_view>

#include "core/error.h"

namespace parkade {
namespace {

constexpr char kArraysOfArrays[] =
    "the message definition in IDL has arrays of arrays, which are not supported";

bool IsOfName(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// The words and signs of a text, without comments, texts in quotes, preprocessor's and rosbag2's
/// lines. A name comes with its modules: "std_msgs::msg::Header".
std::vector<std::string> TokensOf(std::string_view text) {
  std::vector<std::string> tokens;
  const auto skip_to = [&](std::string_view end) {
    text.remove_prefix(std::min(text.size(), text.find(end, 1)));
  };
  while (!text.empty()) {
    if (text.starts_with("//") || text.front() == '#' || text.starts_with("====") ||
        text.starts_with("IDL:")) {
      skip_to("\n");
    } else if (text.starts_with("/*")) {
      skip_to("*/");
      text.remove_prefix(std::min<std::size_t>(2, text.size()));
    } else if (text.front() == '"') {
      skip_to("\"");
      text.remove_prefix(std::min<std::size_t>(1, text.size()));
    } else if (IsOfName(text.front())) {
      std::size_t size = 1;
      while (size < text.size() && (IsOfName(text[size]) || text.substr(size, 2) == "::" ||
                                    text.substr(size - 1, 2) == "::"))
        ++size;
      tokens.emplace_back(text.substr(0, size));
      text.remove_prefix(size);
    } else {
      if (std::isspace(static_cast<unsigned char>(text.front())) == 0)
        tokens.emplace_back(text.substr(0, 1));
      text.remove_prefix(1);
    }
  }
  return tokens;
}

/// "float64" for "double" and the like; empty for other words.
std::string PrimitiveOf(const std::string& word) {
  static const std::map<std::string, std::string> names = {
      {"double", "float64"}, {"float", "float32"}, {"boolean", "bool"},  {"octet", "uint8"},
      {"char", "uint8"},     {"short", "int16"},   {"long", "int32"},    {"int8", "int8"},
      {"uint8", "uint8"},    {"int16", "int16"},   {"uint16", "uint16"}, {"int32", "int32"},
      {"uint32", "uint32"},  {"int64", "int64"},   {"uint64", "uint64"}, {"string", "string"},
      {"wstring", "wstring"}};
  const auto found = names.find(word);
  return found == names.end() ? "" : found->second;
}

/// "std_msgs/Header" for "std_msgs::msg::Header".
std::string RosNameOf(const std::string& scoped) {
  const std::size_t first = scoped.find("::"), last = scoped.rfind("::");
  if (first == std::string::npos) return scoped;
  return scoped.substr(0, first) + "/" + scoped.substr(last + 2);
}

class IdlParser {
 public:
  explicit IdlParser(const std::string& text) : tokens_(TokensOf(text)) {}

  RosDefinition Parse() {
    while (!IsAtEnd()) {
      const std::string token = Take();
      if (token == "module") {
        modules_.push_back(Take());
        Expect("{");
      } else if (token == "}") {
        if (!modules_.empty()) modules_.pop_back();
      } else if (token == "struct") {
        ParseStruct();
      } else if (token == "typedef") {
        const RosField field = ParseDeclaration();
        aliases_[field.name] = field;
      } else if (token == "const") {
        while (Take() != ";") continue;
      } else if (token == "@") {
        SkipAnnotation();
      } else {
        Require(token == ";", ErrorCode::kInvalidInput,
                "the message definition in IDL holds '" + token.substr(0, 40) +
                    "', which is not supported");
      }
    }
    return std::move(definition_);
  }

 private:
  bool IsAtEnd() const { return next_ == tokens_.size(); }
  bool IsNext(std::string_view token) const { return !IsAtEnd() && tokens_[next_] == token; }
  std::string Take() {
    Require(!IsAtEnd(), ErrorCode::kInvalidInput, "the message definition in IDL ends too early");
    return tokens_[next_++];
  }
  bool TakeIf(std::string_view token) {
    if (!IsNext(token)) return false;
    ++next_;
    return true;
  }
  void Expect(const std::string& token) {
    Require(TakeIf(token), ErrorCode::kInvalidInput,
            "the message definition in IDL lacks a '" + token + "'");
  }

  /// Behind its "@".
  void SkipAnnotation() {
    Take();
    if (!TakeIf("(")) return;
    for (int depth = 1; depth > 0;) {
      const std::string token = Take();
      depth += token == "(" ? 1 : token == ")" ? -1 : 0;
    }
  }

  void ParseStruct() {
    const std::string name = (modules_.empty() ? "" : modules_.front() + "/") + Take();
    std::vector<RosField> fields;
    Expect("{");
    while (!TakeIf("}")) {
      if (TakeIf("@"))
        SkipAnnotation();
      else
        fields.push_back(ParseDeclaration());
    }
    // What ROS 2 puts into a message without fields.
    if (fields.size() == 1 && fields[0].name == "structure_needs_at_least_one_member")
      fields.clear();
    definition_.types[name] = std::move(fields);
  }

  /// A type, a name, perhaps a length, and ";".
  RosField ParseDeclaration() {
    RosField field = ParseType();
    field.name = Take();
    if (TakeIf("[")) {
      field = ArrayOf(field, ParseNumber());
      Expect("]");
    }
    Expect(";");
    return field;
  }

  RosField ParseType() {
    std::string word = Take();
    if (word == "sequence") {
      Expect("<");
      Require(!TakeIf("sequence"), ErrorCode::kInvalidInput, kArraysOfArrays);
      RosField field = ArrayOf(ParseType(), std::nullopt);
      SkipBound(",");
      Expect(">");
      return field;
    }
    const bool is_unsigned = word == "unsigned";
    if (is_unsigned) word = Take();
    if (word == "long" && TakeIf("long")) word = "int64";
    if (const auto alias = aliases_.find(word); alias != aliases_.end()) return alias->second;
    const std::string primitive = PrimitiveOf(word);
    if (primitive.ends_with("string") && TakeIf("<")) {
      Take();
      Expect(">");
    }
    return {.type = primitive.empty() ? RosNameOf(word) : (is_unsigned ? "u" : "") + primitive,
            .name = ""};
  }

  void SkipBound(const std::string& begin) {
    if (TakeIf(begin)) Take();
  }

  static RosField ArrayOf(RosField element, std::optional<std::size_t> length) {
    Require(!element.is_array, ErrorCode::kInvalidInput, kArraysOfArrays);
    element.is_array = true;
    element.length = length;
    return element;
  }

  std::size_t ParseNumber() {
    const std::string token = Take();
    std::size_t number = 0;
    const char* end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, number);
    Require(error == std::errc() && stop == end, ErrorCode::kInvalidInput,
            "the message definition in IDL has an array without a length");
    return number;
  }

  std::vector<std::string> tokens_;
  std::size_t next_ = 0;
  std::vector<std::string> modules_;
  std::map<std::string, RosField> aliases_;
  RosDefinition definition_;
};

}  // namespace

bool IsIdl(const std::string& text) {
  return text.starts_with("IDL:") || text.find("\nIDL:") != std::string::npos ||
         text.find("module ") == 0 || text.find("\nmodule ") != std::string::npos;
}

RosDefinition ReadIdlDefinition(const std::string& text, const std::string& type) {
  RosDefinition definition = IdlParser(text).Parse();
  AddKnownTypes(definition, /*is_ros1=*/false);
  Require(definition.types.contains(type), ErrorCode::kInvalidInput,
          "the message definition in IDL does not define " + type);
  definition.main = type;
  return definition;
}

}  // namespace parkade
