#include "export/gltf/draco_encoder.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kMaxPositionBits = 18;
constexpr double kFinestStep = 1.0 / 512;  // [m]
constexpr int kNormalBits = 8;
constexpr int kSigmaBits = 10;
constexpr int kTexcoordBits =
    14;  // an image is at most some thousand texels wide: steps are a fraction of one
// Draco's speed, 0 (smallest) to 10 (fastest); 4 still uses the predictors that matter for a
// surface.
constexpr int kSpeed = 4;

template <typename Value>
int AddAttribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data_type,
                 std::int8_t num_components, bool is_normalized, const std::vector<Value>& values) {
  auto attribute = std::make_unique<draco::PointAttribute>();
  attribute->Init(type, num_components, data_type, is_normalized, values.size());
  for (size_t i = 0; i < values.size(); ++i)
    attribute->SetAttributeValue(draco::AttributeValueIndex(static_cast<std::uint32_t>(i)),
                                 &values[i]);
  return mesh.AddAttribute(std::move(attribute));
}

struct PositionLattice {
  Eigen::Vector3f origin;
  int bits = 1;
  float range = 0;  ///< [m]
};

PositionLattice ChooseLattice(const std::vector<Eigen::Vector3f>& positions) {
  const Box3f box = BoundingBox(positions);
  const double step = DracoStep(static_cast<double>((box.max - box.min).maxCoeff()));
  PositionLattice lattice;
  lattice.origin = ((box.min.cast<double>() / step).array().floor() * step).matrix().cast<float>();
  const double extent = static_cast<double>((box.max - lattice.origin).maxCoeff());
  while (step * (std::exp2(lattice.bits) - 1) < extent) ++lattice.bits;
  lattice.range = static_cast<float>(step * (std::exp2(lattice.bits) - 1));
  return lattice;
}

}  // namespace

double DracoStep(double extent) {
  double step = kFinestStep;
  while (extent + step > step * (std::exp2(kMaxPositionBits) - 1)) step *= 2;
  return step;
}

DracoMesh EncodeDraco(const GltfGeometry& geometry) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(geometry.positions.size()));
  mesh.SetNumFaces(geometry.triangles.size());
  for (size_t i = 0; i < geometry.triangles.size(); ++i) {
    const auto& [a, b, c] = geometry.triangles[i];
    mesh.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(i)),
                 {draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
  }
  using Attribute = draco::GeometryAttribute;
  const int position =
      AddAttribute(mesh, Attribute::POSITION, draco::DT_FLOAT32, 3, false, geometry.positions);
  const int normal =
      AddAttribute(mesh, Attribute::NORMAL, draco::DT_FLOAT32, 3, false, geometry.normals);
  std::optional<int> color, texcoord;
  if (!geometry.colors.empty())
    color = AddAttribute(mesh, Attribute::COLOR, draco::DT_UINT16, 4, true, geometry.colors);
  if (!geometry.texcoords.empty())
    texcoord =
        AddAttribute(mesh, Attribute::TEX_COORD, draco::DT_FLOAT32, 2, false, geometry.texcoords);
  const int sigma =
      AddAttribute(mesh, Attribute::GENERIC, draco::DT_FLOAT32, 1, false, geometry.height_sigmas);

  draco::ExpertEncoder encoder(mesh);
  const PositionLattice lattice = ChooseLattice(geometry.positions);
  encoder.SetAttributeExplicitQuantization(position, lattice.bits, 3, lattice.origin.data(),
                                           lattice.range);
  encoder.SetAttributeQuantization(normal, kNormalBits);
  encoder.SetAttributeQuantization(sigma, kSigmaBits);
  if (texcoord) encoder.SetAttributeQuantization(*texcoord, kTexcoordBits);
  encoder.SetSpeedOptions(kSpeed, kSpeed);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetTrackEncodedProperties(true);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  Require(status.ok(), ErrorCode::kInternal,
          std::string("Draco could not compress the mesh: ") + status.error_msg());

  const auto unique_id = [&](int attribute) {
    return static_cast<int>(mesh.attribute(attribute)->unique_id());
  };
  std::map<std::string, int> ids = {{"POSITION", unique_id(position)},
                                    {"NORMAL", unique_id(normal)},
                                    {"_HEIGHT_SIGMA", unique_id(sigma)}};
  if (color) ids["COLOR_0"] = unique_id(*color);
  if (texcoord) ids["TEXCOORD_0"] = unique_id(*texcoord);
  return {.bytes = std::string(buffer.data(), buffer.size()),
          .attribute_ids = ids,
          .num_vertices = encoder.num_encoded_points(),
          .num_triangles = encoder.num_encoded_faces()};
}

}  // namespace parkade
