#include "server/ingest/schemas/message_path.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "core/error.h"
#include "server/ingest/files/euroc_csv.h"

namespace parkade {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::optional<double> NumberOf(const MessageTree& value) {
  if (value.is_null()) return kNan;
  if (value.is_number()) return value.get<double>();
  if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
  if (value.is_string()) return ParseDouble(value.get_ref<const std::string&>());
  return std::nullopt;
}

/// The field of an object, or nothing.
const MessageTree* FieldOf(const MessageTree& message, const std::string& name) {
  if (!message.is_object()) return nullptr;
  const auto found = message.find(name);
  return found == message.end() ? nullptr : &*found;
}

bool IsText(const MessageTree* value, const std::string& text) {
  return value != nullptr && value->is_string() && value->get_ref<const std::string&>() == text;
}

/// The names of an array's elements: beside it, or within each.
std::vector<const MessageTree*> NamesOf(const std::string& key, const MessageTree& array,
                                        const MessageTree& parent) {
  const MessageTree* names = FieldOf(parent, key);
  const bool are_beside = names != nullptr && names->is_array();
  const MessageTree& searched = are_beside ? *names : array;
  std::vector<const MessageTree*> found;
  for (std::size_t i = 0; searched.is_array() && i < searched.size(); ++i)
    found.push_back(are_beside ? &searched[i] : FieldOf(searched[i], key));
  return found;
}

/// The index of the element with a name.
std::optional<std::size_t> IndexOf(const std::string& wanted,
                                   const std::vector<const MessageTree*>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (IsText(names[i], wanted)) return i;
  return std::nullopt;
}

void ListInto(const MessageTree& value, const std::string& path, std::vector<std::string>& paths) {
  constexpr std::size_t kMaxPaths = 40;
  if (paths.size() >= kMaxPaths) return;
  const auto add_range = [&](std::size_t size) {
    if (size > 0) paths.push_back(path + "[0.." + std::to_string(size - 1) + "]");
  };
  if (value.is_object()) {
    for (const auto& [name, field] : value.items())
      ListInto(field, std::string(path).append(path.empty() ? "" : ".").append(name), paths);
  } else if (value.is_binary()) {
    add_range(value.get_binary().size());
  } else if (value.is_array() && !value.empty() && value.front().is_structured()) {
    ListInto(value.front(), path + "[0]", paths);
  } else if (value.is_array()) {
    if (!value.empty() && NumberOf(value.front())) add_range(value.size());
  } else if (NumberOf(value)) {
    paths.push_back(path);
  }
}

int Base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  return c == '/' || c == '_' ? 63 : -1;
}

std::vector<std::uint8_t> DecodeBase64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() * 3 / 4);
  unsigned bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    const int digit = Base64Digit(c);
    Require(digit >= 0, ErrorCode::kInvalidInput, "the message's data are not base64");
    bits = (bits << 6 | static_cast<unsigned>(digit)) & 0xffffU;
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> num_bits & 0xffU));
  }
  return bytes;
}

}  // namespace

MessagePath::MessagePath(const std::string& text) : text_(text) {
  const std::string what = "'" + text +
                           "' is no path into a message: write it as twist.linear.x, " +
                           "data[3] or velocity[name=rear_left]";
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of(".["), rest.size());
    if (end > 0) steps_.push_back(Step{.field = std::string(rest.substr(0, end))});
    Require(end > 0 || (rest.front() == '[' && !steps_.empty()), ErrorCode::kInvalidInput, what);
    rest.remove_prefix(end);
    while (rest.starts_with('[')) {
      const std::size_t close = rest.find(']');
      Require(close != std::string_view::npos, ErrorCode::kInvalidInput, what);
      const std::string_view inside = rest.substr(1, close - 1);
      const std::size_t equals = inside.find('=');
      Step step;
      if (equals != std::string_view::npos) {
        step.key = inside.substr(0, equals);
        step.wanted = inside.substr(equals + 1);
        Require(!step.key.empty(), ErrorCode::kInvalidInput, what);
      } else {
        const auto [stop, error] =
            std::from_chars(inside.data(), inside.data() + inside.size(), step.index);
        Require(error == std::errc() && stop == inside.data() + inside.size(),
                ErrorCode::kInvalidInput, what);
      }
      steps_.push_back(step);
      rest.remove_prefix(close + 1);
    }
    if (rest.empty()) break;
    Require(rest.starts_with('.') && rest.size() > 1, ErrorCode::kInvalidInput, what);
    rest.remove_prefix(1);
  }
  Require(!steps_.empty(), ErrorCode::kInvalidInput, what);
}

std::optional<double> MessagePath::Number(const MessageTree& message) const {
  const MessageTree* value = &message;
  const MessageTree* parent = &message;
  for (const Step& step : steps_) {
    if (value->is_null()) return 0;
    if (!step.field.empty()) {
      parent = value;
      value = FieldOf(*value, step.field);
      if (value == nullptr) return std::nullopt;
      continue;
    }
    const std::optional<std::size_t> index =
        step.key.empty() ? std::optional(step.index)
                         : IndexOf(step.wanted, NamesOf(step.key, *value, *parent));
    if (!index) return std::nullopt;
    if (value->is_binary()) {
      const auto& bytes = value->get_binary();
      if (*index >= bytes.size() || &step != &steps_.back()) return std::nullopt;
      return bytes[*index];
    }
    if (!value->is_array() || *index >= value->size()) return std::nullopt;
    value = &(*value)[*index];
  }
  return NumberOf(*value);
}

std::vector<std::string> MessagePath::NamesInstead(const MessageTree& message) const {
  const MessageTree* value = &message;
  const MessageTree* parent = &message;
  for (const Step& step : steps_) {
    if (!step.field.empty()) {
      parent = value;
      value = FieldOf(*value, step.field);
      if (value == nullptr) return {};
      continue;
    }
    std::size_t index = step.index;
    if (!step.key.empty()) {
      const std::vector<const MessageTree*> names = NamesOf(step.key, *value, *parent);
      const std::optional<std::size_t> found = IndexOf(step.wanted, names);
      std::vector<std::string> texts;
      for (const MessageTree* name : names)
        if (name != nullptr && name->is_string()) texts.push_back(name->get<std::string>());
      if (!found) return texts;
      index = *found;
    }
    if (!value->is_array() || index >= value->size()) return {};
    value = &(*value)[index];
  }
  return {};
}

std::string ListNumbers(const MessageTree& message) {
  std::vector<std::string> paths;
  ListInto(message, "", paths);
  std::string list;
  for (std::size_t i = 0; i < paths.size(); ++i)
    list.append(i == 0 ? "" : i + 1 < paths.size() ? ", " : " and ").append(paths[i]);
  return list.empty() ? "none" : list;
}

Timestamp StampIn(const MessageTree& message) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const MessageTree* header = FieldOf(message, "header");
  const MessageTree* time = header != nullptr ? FieldOf(*header, "stamp") : nullptr;
  if (time == nullptr) time = FieldOf(message, "timestamp");
  if (time == nullptr) time = FieldOf(message, "stamp");
  if (time == nullptr) return {};
  const auto sum = [&](std::initializer_list<const char*> names) {
    double number = 0;
    for (const char* name : names)
      if (const MessageTree* part = FieldOf(*time, name)) number += NumberOf(*part).value_or(0);
    constexpr double kMax = 4294967295.0;  // what 32 bits hold
    return number >= 0 && number <= kMax ? static_cast<std::int64_t>(number) : 0;
  };
  return {sum({"sec", "secs", "seconds"}) * kSecond + sum({"nsec", "nsecs", "nanosec", "nanos"})};
}

double NumberAt(const MessageTree& message, const char* path) {
  return MessagePath(path).Number(message).value_or(0);
}

std::string TextAt(const MessageTree& message, const std::string& field) {
  const MessageTree* value = FieldOf(message, field);
  return value != nullptr && value->is_string() ? value->get<std::string>() : "";
}

std::vector<std::uint8_t> BytesAt(const MessageTree& message, const std::string& field) {
  const MessageTree* value = FieldOf(message, field);
  if (value == nullptr) return {};
  if (value->is_binary()) return value->get_binary();
  if (value->is_string()) return DecodeBase64(value->get_ref<const std::string&>());
  const std::vector<double> numbers = NumbersAt(message, field);
  std::vector<std::uint8_t> bytes;
  for (const double number : numbers) {
    Require(number >= 0 && number <= 255, ErrorCode::kInvalidInput,
            "the message's data are no bytes");
    bytes.push_back(static_cast<std::uint8_t>(number));
  }
  return bytes;
}

std::vector<double> NumbersAt(const MessageTree& message, const std::string& field) {
  const MessageTree* value = FieldOf(message, field);
  std::vector<double> numbers;
  for (std::size_t i = 0; value != nullptr && value->is_array() && i < value->size(); ++i)
    numbers.push_back(NumberOf((*value)[i]).value_or(kNan));
  return numbers;
}

}  // namespace parkade
