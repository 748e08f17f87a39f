#include "tests/mapping/worlds/synthetic_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

/// Reproducible noise in [0, 1) of a lattice point.
double Hash(int x, int y) {
  std::uint32_t h =
      static_cast<std::uint32_t>(x) * 374761393U + static_cast<std::uint32_t>(y) * 668265263U;
  h = (h ^ (h >> 13)) * 1274126177U;
  return static_cast<double>((h ^ (h >> 16)) & 0xFFFFU) / 65536.0;
}

/// Smooth noise with details of `size` [m].
double Noise(double x, double y, double size) {
  const double u = x / size, v = y / size;
  const int i = static_cast<int>(std::floor(u)), k = static_cast<int>(std::floor(v));
  const double fu = u - i, fv = v - k;
  return (Hash(i, k) * (1 - fu) + Hash(i + 1, k) * fu) * (1 - fv) +
         (Hash(i, k + 1) * (1 - fu) + Hash(i + 1, k + 1) * fu) * fv;
}

bool IsOnLine(double coordinate, double period) {
  return std::abs(coordinate - period * std::round(coordinate / period)) < 0.06;
}

}  // namespace

void SyntheticScene::AddQuad(const SceneQuad& quad) {
  quads_.push_back(quad);
  normals_.push_back(quad.u.cross(quad.v).normalized());
}

void SyntheticScene::AddBox(const Eigen::Vector3d& center_of_bottom, const Eigen::Vector3d& size,
                            const Bgr& color) {
  const Eigen::Vector3d low = center_of_bottom - Eigen::Vector3d(0.5 * size.x(), 0.5 * size.y(), 0);
  const Eigen::Vector3d x = size.x() * Eigen::Vector3d::UnitX(),
                        y = size.y() * Eigen::Vector3d::UnitY(),
                        z = size.z() * Eigen::Vector3d::UnitZ();
  const auto shaded = [&](double factor) {
    Bgr result = color;
    for (std::uint8_t& channel : result) channel = static_cast<std::uint8_t>(channel * factor);
    return result;
  };
  AddQuad({.corner = low + z, .u = x, .v = y, .color = color});
  AddQuad({.corner = low, .u = x, .v = z, .color = shaded(0.8)});
  AddQuad({.corner = low + y, .u = x, .v = z, .color = shaded(0.6)});
  AddQuad({.corner = low, .u = y, .v = z, .color = shaded(0.7)});
  AddQuad({.corner = low + x, .u = y, .v = z, .color = shaded(0.9)});
  boxes_.push_back({low.head<2>(), (low + x + y).head<2>(), low.z()});
}

Bgr SyntheticScene::ColorAt(const SceneQuad& quad, const Eigen::Vector3d& point) {
  if (quad.has_slots && std::abs(point.y()) < 5.56 &&
      ((std::abs(point.y()) > 3 && IsOnLine(point.x(), 2.5)) ||
       std::abs(std::abs(point.y()) - 5.5) < 0.06))
    return {225, 225, 225};
  Bgr color = quad.color;
  const double noise =
      quad.noise * (Noise(point.x(), point.y(), 0.08) + Noise(point.x(), point.y(), 1.1) - 1);
  for (std::uint8_t& channel : color)
    channel = static_cast<std::uint8_t>(std::clamp(channel + noise, 0.0, 255.0));
  return color;
}

SyntheticScene::Hit SyntheticScene::Trace(const Eigen::Vector3d& origin,
                                          const Eigen::Vector3d& direction) const {
  Hit hit{.color = {235, 215, 190}};
  const SceneQuad* nearest = nullptr;
  for (size_t i = 0; i < quads_.size(); ++i) {
    const SceneQuad& quad = quads_[i];
    const double along = normals_[i].dot(direction);
    if (std::abs(along) < 1e-9) continue;
    const double distance = normals_[i].dot(quad.corner - origin) / along;
    if (distance < 1e-6 || distance >= hit.distance) continue;
    const Eigen::Vector3d offset = origin + distance * direction - quad.corner;
    const double a = offset.dot(quad.u) / quad.u.squaredNorm(),
                 b = offset.dot(quad.v) / quad.v.squaredNorm();
    if (a < 0 || a > 1 || b < 0 || b > 1) continue;
    hit.distance = distance;
    nearest = &quad;
  }
  if (nearest == nullptr) return hit;
  hit.is_drivable = nearest->is_drivable;
  hit.color = ColorAt(*nearest, origin + hit.distance * direction);
  return hit;
}

std::optional<double> SyntheticScene::GroundHeight(double x, double y, double z) const {
  std::optional<double> nearest;
  for (size_t i = 0; i < quads_.size(); ++i) {
    const SceneQuad& quad = quads_[i];
    if (!quad.is_drivable) continue;
    const Eigen::Vector3d& n = normals_[i];
    const double height =
        quad.corner.z() - (n.x() * (x - quad.corner.x()) + n.y() * (y - quad.corner.y())) / n.z();
    const Eigen::Vector3d offset = Eigen::Vector3d(x, y, height) - quad.corner;
    const double a = offset.dot(quad.u) / quad.u.squaredNorm(),
                 b = offset.dot(quad.v) / quad.v.squaredNorm();
    if (a < 0 || a > 1 || b < 0 || b > 1) continue;
    if (!nearest || std::abs(height - z) < std::abs(*nearest - z)) nearest = height;
  }
  return nearest;
}

TriangleMesh SyntheticScene::DrivableMesh() const {
  TriangleMesh mesh;
  const auto is_covered = [&](const Eigen::Vector3d& point) {
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& box) {
      return (point.head<2>().array() > box.low.array()).all() &&
             (point.head<2>().array() < box.high.array()).all() &&
             std::abs(point.z() - box.bottom) < 0.5;
    });
  };
  for (const SceneQuad& quad : quads_) {
    if (!quad.is_drivable) continue;
    const int nu = static_cast<int>(std::round(quad.u.norm() / 0.1)),
              nv = static_cast<int>(std::round(quad.v.norm() / 0.1));
    for (int k = 0; k < nv; ++k)
      for (int i = 0; i < nu; ++i) {
        const auto corner = [&](double a, double b) {
          return Eigen::Vector3d(quad.corner + quad.u * (i + a) / nu + quad.v * (k + b) / nv);
        };
        if (is_covered(corner(0.5, 0.5))) continue;
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const auto& [a, b] :
             {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
          mesh.vertices.push_back(corner(a, b).cast<float>());
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
      }
  }
  mesh.normals.assign(mesh.vertices.size(), Eigen::Vector3f::UnitZ());
  mesh.colors.assign(mesh.vertices.size(), {128, 128, 128});
  mesh.height_sigmas.assign(mesh.vertices.size(), 0);
  return mesh;
}

SyntheticScene MakeLot() {
  SyntheticScene scene;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  scene.AddQuad({.corner = {-24, -8, 0},
                 .u = 48 * x,
                 .v = 16 * y,
                 .is_drivable = true,
                 .has_slots = true,
                 .color = {95, 92, 90},
                 .noise = 12});
  for (const double side : {8.0, -12.0})
    scene.AddQuad(
        {.corner = {-24, side, 0}, .u = 48 * x, .v = 4 * y, .color = {165, 175, 180}, .noise = 10});
  for (const double side : {12.0, -12.0})
    scene.AddQuad(
        {.corner = {-24, side, 0}, .u = 48 * x, .v = 3 * z, .color = {110, 130, 160}, .noise = 20});
  for (const double side : {24.0, -24.0})
    scene.AddQuad(
        {.corner = {side, -12, 0}, .u = 24 * y, .v = 3 * z, .color = {110, 130, 160}, .noise = 20});
  const std::array<Bgr, 4> paints{{{160, 40, 30}, {30, 40, 170}, {220, 220, 220}, {50, 120, 40}}};
  int number = 0;
  for (const double slot : {-16.25, -11.25, -3.75, 1.25, 8.75, 16.25})
    for (const double side : {1.0, -1.0})
      scene.AddBox({slot, side * 5.6, 0}, {1.8, 4.2, 1.5},
                   paints[static_cast<size_t>(number++ % 4)]);
  return scene;
}

SyntheticScene MakeDecks() {
  SyntheticScene scene;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const SceneQuad floor{.is_drivable = true, .color = {110, 110, 112}, .noise = 14};
  const auto add_floor = [&](const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                             const Eigen::Vector3d& v) {
    SceneQuad quad = floor;
    quad.corner = corner, quad.u = u, quad.v = v;
    scene.AddQuad(quad);
  };
  add_floor({-12, -4, 0}, 22 * x, 18 * y);        // lower deck
  add_floor({10, -3, 0}, 25 * x + 3 * z, 6 * y);  // ramp
  add_floor({35, -4, 3}, 14 * x, 18 * y);         // landing
  add_floor({-12, 6, 3}, 47 * x, 8 * y);          // upper deck, back over the lower
  scene.AddQuad(
      {.corner = {-12, 6, 2.8}, .u = 47 * x, .v = 8 * y, .color = {60, 60, 70}});  // its underside
  for (const double side : {-4.0, 14.0})
    scene.AddQuad(
        {.corner = {-12, side, 0}, .u = 61 * x, .v = 6 * z, .color = {60, 110, 170}, .noise = 20});
  for (const double side : {-12.0, 49.0})
    scene.AddQuad(
        {.corner = {side, -4, 0}, .u = 18 * y, .v = 6 * z, .color = {60, 110, 170}, .noise = 20});
  return scene;
}

}  // namespace parkade
