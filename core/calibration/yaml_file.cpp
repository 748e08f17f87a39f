#include "core/calibration/yaml_file.h"

#include <utility>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

constexpr size_t kMaxBytes = size_t{1} << 20;

[[noreturn]] void Fail(const std::string& message) {
  throw Error(ErrorCode::kInvalidInput, message);
}

}  // namespace

bool YamlNode::Has(const std::string& key) const {
  return node_.IsMap() && node_[key].IsDefined() && !node_[key].IsNull();
}

YamlNode YamlNode::At(const std::string& key) const {
  if (!Has(key)) Fail(where_ + " has no '" + key + "'");
  return {node_[key],
          where_ + (where_.ends_with(".yaml") || where_.ends_with(".json") ? ": " : ".") + key};
}

std::string YamlNode::Text() const {
  if (!node_.IsScalar()) Fail(where_ + " must be a text");
  return node_.Scalar();
}

double YamlNode::Number() const {
  double number = 0;
  if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, number))
    Fail(where_ + " must be a number");
  if (!std::isfinite(number)) Fail(where_ + " is not finite");
  return number;
}

int YamlNode::Integer() const {
  const double number = Number();
  if (number != std::round(number) || std::abs(number) > 1e9)
    Fail(where_ + " must be a whole number");
  return static_cast<int>(number);
}

std::vector<double> YamlNode::Numbers() const {
  if (!node_.IsSequence()) Fail(where_ + " must be a list of numbers");
  std::vector<double> numbers;
  for (const YAML::Node& item : node_) numbers.push_back(YamlNode(item, where_).Number());
  return numbers;
}

std::vector<YamlNode> YamlNode::Items() const {
  if (!node_.IsSequence()) Fail(where_ + " must be a list");
  std::vector<YamlNode> items;
  for (const YAML::Node& item : node_)
    items.emplace_back(item, where_ + "[" + std::to_string(items.size()) + "]");
  return items;
}

YamlNode YamlNode::With(const YAML::Node& entries) const {
  YAML::Node all = YAML::Clone(node_);
  for (const auto& entry : entries) all[entry.first] = entry.second;
  return {all, where_};
}

Rigid3 YamlNode::Motion() const {
  // An OpenCV matrix has its numbers in "data". That may be the matrix itself, by an alias.
  const YAML::Node node = Has("data") ? node_["data"] : node_;
  std::vector<double> numbers;
  if (node.IsSequence() && node.size() > 0 && node[0].IsSequence()) {
    for (const YAML::Node& row : node) {
      const std::vector<double> row_numbers = YamlNode(row, where_).Numbers();
      if (row_numbers.size() != 4) Fail(where_ + " must be a 4x4 matrix");
      numbers.insert(numbers.end(), row_numbers.begin(), row_numbers.end());
    }
  } else {
    numbers = YamlNode(node, where_).Numbers();
  }
  if (numbers.size() != 16) Fail(where_ + " must be a 4x4 matrix");
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(numbers.data());
  try {
    return Rigid3::FromMatrix(matrix);
  } catch (const Error& error) {
    Fail(where_ + ": " + error.what());
  }
}

std::vector<std::string> YamlNode::Keys() const {
  std::vector<std::string> keys;
  if (!node_.IsMap()) Fail(where_ + " must be a list of 'key: value'");
  for (const auto& entry : node_)
    keys.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "");
  return keys;
}

YamlNode ReadYaml(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  Require(std::filesystem::is_regular_file(file), ErrorCode::kInvalidInput,
          "the rig folder '" + file.parent_path().filename().string() + "' has no " + name);
  std::string text = ReadFile(file, kMaxBytes);
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
  try {
    YamlNode node(YAML::Load(text), name);
    node.Keys();
    return node;
  } catch (const YAML::Exception& error) {
    Fail(name + " is not YAML: line " + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
}

}  // namespace parkade
