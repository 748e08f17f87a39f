#include "mapping/mesh/read_ply.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct Property {
  std::string name;
  Scalar type{};
  std::optional<Scalar> count_type;  ///< set: a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool is_ascii = false;
  std::vector<Element> elements;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::size_t size = 0;  ///< [bytes]
};

const std::map<std::string, Scalar> kScalars = {
    {"char", Scalar::kInt8},      {"int8", Scalar::kInt8},       {"uchar", Scalar::kUint8},
    {"uint8", Scalar::kUint8},    {"short", Scalar::kInt16},     {"int16", Scalar::kInt16},
    {"ushort", Scalar::kUint16},  {"uint16", Scalar::kUint16},   {"int", Scalar::kInt32},
    {"int32", Scalar::kInt32},    {"uint", Scalar::kUint32},     {"uint32", Scalar::kUint32},
    {"float", Scalar::kFloat32},  {"float32", Scalar::kFloat32}, {"double", Scalar::kFloat64},
    {"float64", Scalar::kFloat64}};

void RequireKnownFormat(const std::string& format, const std::string& where) {
  Require(format == "ascii" || format == "binary_little_endian", ErrorCode::kInvalidInput,
          where + " is PLY of the unsupported format '" + format + "'");
}

Scalar ParseScalar(const std::string& name, const std::string& where) {
  const auto found = kScalars.find(name);
  Require(found != kScalars.end(), ErrorCode::kInvalidInput,
          where + " has a property of unknown type '" + name + "'");
  return found->second;
}

void ParseProperty(std::istringstream& words, Header& header, const std::string& where) {
  Require(!header.elements.empty(), ErrorCode::kInvalidInput,
          where + " has a property before any element");
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string count_type;
    words >> count_type >> type;
    property.count_type = ParseScalar(count_type, where);
  }
  words >> property.name;
  property.type = ParseScalar(type, where);
  header.elements.back().properties.push_back(property);
}

Header ParseHeader(std::string_view content, const std::string& where) {
  Header header;
  bool has_format = false;
  for (int number = 0;; ++number) {
    const std::size_t end = content.find('\n', header.size);
    Require(end != std::string_view::npos, ErrorCode::kInvalidInput,
            where + " has no complete PLY header");
    std::istringstream words{std::string(content.substr(header.size, end - header.size))};
    header.size = end + 1;
    std::string keyword, second;
    words >> keyword;
    Require((keyword == "ply") == (number == 0), ErrorCode::kInvalidInput,
            where + " is not a PLY file");
    if (keyword == "format") {
      words >> second;
      header.is_ascii = second == "ascii";
      RequireKnownFormat(second, where);
      has_format = true;
    } else if (keyword == "comment") {
      Eigen::Vector3d origin;
      if (words >> second && second == "origin" && words >> origin.x() >> origin.y() >> origin.z())
        header.origin = origin;
    } else if (keyword == "element") {
      Element& element = header.elements.emplace_back();
      words >> element.name >> element.count;
      Require(!words.fail(), ErrorCode::kInvalidInput, where + " has an element without a count");
    } else if (keyword == "property") {
      ParseProperty(words, header, where);
    } else if (keyword == "end_header") {
      break;
    }
  }
  Require(has_format, ErrorCode::kInvalidInput, where + " does not say its PLY format");
  return header;
}

/// The numbers behind the header, one after the other.
class ValueReader {
 public:
  ValueReader(std::string_view body, bool is_ascii, std::string where)
      : body_(body), is_ascii_(is_ascii), where_(std::move(where)) {}

  double Next(Scalar type) {
    if (is_ascii_) return NextWord();
    switch (type) {
      case Scalar::kInt8: return Take<std::int8_t>();
      case Scalar::kUint8: return Take<std::uint8_t>();
      case Scalar::kInt16: return Take<std::int16_t>();
      case Scalar::kUint16: return Take<std::uint16_t>();
      case Scalar::kInt32: return Take<std::int32_t>();
      case Scalar::kUint32: return Take<std::uint32_t>();
      case Scalar::kFloat32: return static_cast<double>(Take<float>());
      case Scalar::kFloat64: return Take<double>();
    }
    return 0;
  }

 private:
  template <typename T>
  T Take() {
    Require(body_.size() >= sizeof(T), ErrorCode::kInvalidInput,
            where_ + " ends before its last element");
    T value;
    std::memcpy(&value, body_.data(), sizeof value);
    body_.remove_prefix(sizeof value);
    return value;
  }

  double NextWord() {
    const std::size_t begin = body_.find_first_not_of(" \t\r\n");
    Require(begin != std::string_view::npos, ErrorCode::kInvalidInput,
            where_ + " ends before its last element");
    const std::size_t end = std::min(body_.find_first_of(" \t\r\n", begin), body_.size());
    const std::string word(body_.substr(begin, end - begin));
    body_.remove_prefix(end);
    char* rest = nullptr;
    const double value = std::strtod(word.c_str(), &rest);
    Require(*rest == '\0', ErrorCode::kInvalidInput,
            where_ + " has '" + word + "' where a number should be");
    return value;
  }

  std::string_view body_;
  bool is_ascii_;
  std::string where_;
};

/// A mesh being read; doubles until its origin is known.
struct RawMesh {
  std::vector<Eigen::Vector3d> vertices;
  TriangleMesh mesh;
  bool has_normals = false;
};

void ReadVertices(const Element& element, ValueReader& values, RawMesh& raw) {
  const auto has = [&](const std::string& name) {
    return std::any_of(element.properties.begin(), element.properties.end(),
                       [&](const Property& property) { return property.name == name; });
  };
  raw.has_normals = has("nx") && has("ny") && has("nz");
  for (std::size_t i = 0; i < element.count; ++i) {
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
    std::array<std::uint8_t, 3> color{128, 128, 128};
    double sigma = 0;
    auto surface = static_cast<double>(SurfaceClass::kUnknown);
    for (const Property& property : element.properties) {
      const auto count =
          property.count_type
              ? static_cast<std::size_t>(std::max(values.Next(*property.count_type), 0.0))
              : 1;
      double value = 0;
      for (std::size_t k = 0; k < count; ++k) value = values.Next(property.type);
      const std::string& name = property.name;
      if (name == "x" || name == "y" || name == "z") vertex[name[0] - 'x'] = value;
      if (name == "nx" || name == "ny" || name == "nz") normal[name[1] - 'x'] = value;
      const auto channel = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
      if (name == "red") color[0] = channel;
      if (name == "green") color[1] = channel;
      if (name == "blue") color[2] = channel;
      if (name == "height_sigma") sigma = value;
      if (name == "surface" && value >= 0 && value < surface) surface = value;
    }
    raw.vertices.push_back(vertex);
    raw.mesh.normals.push_back(normal.cast<float>());
    raw.mesh.colors.push_back(color);
    raw.mesh.height_sigmas.push_back(static_cast<float>(sigma));
    raw.mesh.surfaces.push_back(static_cast<SurfaceClass>(surface));
  }
}

void ReadFaces(const Element& element, ValueReader& values, TriangleMesh& mesh) {
  for (std::size_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties) {
      const auto count =
          property.count_type
              ? static_cast<std::size_t>(std::max(values.Next(*property.count_type), 0.0))
              : 1;
      const bool is_face = property.name == "vertex_indices" || property.name == "vertex_index";
      std::uint32_t first = 0, previous = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double value = values.Next(property.type);
        // What does not fit becomes an index that no mesh has.
        const auto index =
            value >= 0 && value < 4294967295.0 ? static_cast<std::uint32_t>(value) : UINT32_MAX;
        if (k == 0) first = index;
        if (is_face && k >= 2) mesh.triangles.push_back({first, previous, index});
        previous = index;
      }
    }
}

void Skip(const Element& element, ValueReader& values) {
  for (std::size_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties) {
      const auto count =
          property.count_type
              ? static_cast<std::size_t>(std::max(values.Next(*property.count_type), 0.0))
              : 1;
      for (std::size_t k = 0; k < count; ++k) values.Next(property.type);
    }
}

void WorkOutNormals(TriangleMesh& mesh) {
  std::vector<Eigen::Vector3f> sums(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f normal =
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const std::uint32_t vertex : {a, b, c}) sums[vertex] += normal;
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i].norm() > 0) mesh.normals[i] = sums[i].normalized();
}

}  // namespace

TriangleMesh ReadPly(const std::filesystem::path& file) {
  const std::string content = ReadFile(file, std::size_t{4} << 30);
  const std::string where = "'" + file.filename().string() + "'";
  const Header header = ParseHeader(content, where);
  ValueReader values(std::string_view(content).substr(header.size), header.is_ascii, where);
  RawMesh raw;
  for (const Element& element : header.elements) {
    // An element without properties takes no bytes, so that its count would bound nothing.
    if (element.properties.empty()) continue;
    if (element.name == "vertex")
      ReadVertices(element, values, raw);
    else if (element.name == "face")
      ReadFaces(element, values, raw.mesh);
    else
      Skip(element, values);
  }
  TriangleMesh& mesh = raw.mesh;
  for (const Eigen::Vector3d& vertex : raw.vertices)
    Require(vertex.allFinite(), ErrorCode::kInvalidInput,
            where + " has a vertex that is not finite");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle)
      Require(index < raw.vertices.size(), ErrorCode::kInvalidInput,
              where + " has a face beyond its vertices");
  const Eigen::Vector3d first =
      raw.vertices.empty() ? Eigen::Vector3d::Zero() : raw.vertices.front();
  const Eigen::Vector3d amid = first.array().round();
  for (const Eigen::Vector3d& vertex : raw.vertices)
    mesh.vertices.push_back((vertex - amid).cast<float>());
  mesh.origin = amid + header.origin;
  if (!raw.has_normals) WorkOutNormals(mesh);
  ValidateMesh(mesh);
  return mesh;
}

}  // namespace parkade
