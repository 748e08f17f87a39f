#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/rigid3.h"

namespace parkade {

/// A node of a YAML file that knows where it is, so that every error names file and key in one
/// sentence. Private to core/calibration. All functions throw Error{kInvalidInput}.
class YamlNode {  // NOLINT(bugprone-exception-escape): a copy of yaml-cpp's node may throw
 public:
  YamlNode(const YAML::Node& node, std::string where) : node_(node), where_(std::move(where)) {}

  bool IsMap() const { return node_.IsMap(); }
  bool IsList() const { return node_.IsSequence(); }
  bool Has(const std::string& key) const;
  YamlNode At(const std::string& key) const;

  std::string Text() const;
  double Number() const;
  int Integer() const;
  std::vector<double> Numbers() const;
  /// The elements of a list, each at "key[index]".
  std::vector<YamlNode> Items() const;
  /// This map with the entries of another.
  YamlNode With(const YAML::Node& entries) const;

  /// A 4 x 4 matrix as nested lists, a flat list of 16, or an OpenCV matrix.
  Rigid3 Motion() const;

  /// Keys of a map in the order of the file.
  std::vector<std::string> Keys() const;

  /// "file: key.key"
  const std::string& where() const { return where_; }

 private:
  YAML::Node node_;
  std::string where_;
};

/// Parses a file; a "%YAML:1.0" of OpenCV's dialect is skipped.
YamlNode ReadYaml(const std::filesystem::path& file);

}  // namespace parkade
