#include "tests/simulator/vehicle/car_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

/// The outline of a body type, seen from the left; x from the tail forward.
struct CarShape {
  double length, half_width;  ///< [m]
  double belt;                ///< [m] height of the lower edge of the windows
  double rear_overhang, wheelbase, wheel_radius;
  std::vector<std::array<double, 2>> top;  ///< (x, z) along the upper outline, tail to nose
};

const CarShape& ShapeOf(int style) {
  static const std::array<CarShape, 3> shapes = {{
      {3.95,
       0.87,
       0.93,
       0.72,
       2.50,
       0.30,
       {{0, 0.62},
        {0.05, 0.95},
        {0.42, 1.36},
        {0.75, 1.45},
        {1.75, 1.48},
        {2.05, 1.43},
        {2.82, 0.98},
        {3.70, 0.80},
        {3.90, 0.66},
        {3.95, 0.50}}},
      {4.60,
       0.91,
       0.92,
       0.98,
       2.72,
       0.32,
       {{0, 0.62},
        {0.05, 0.96},
        {0.70, 1.02},
        {1.35, 1.36},
        {1.75, 1.43},
        {2.45, 1.44},
        {2.75, 1.38},
        {3.45, 0.98},
        {4.30, 0.82},
        {4.55, 0.66},
        {4.60, 0.50}}},
      {4.75,
       0.96,
       1.12,
       0.85,
       2.95,
       0.34,
       {{0, 0.70},
        {0.05, 1.15},
        {0.18, 1.76},
        {0.45, 1.84},
        {3.00, 1.86},
        {3.30, 1.78},
        {3.95, 1.16},
        {4.50, 0.98},
        {4.70, 0.72},
        {4.75, 0.52}}},
  }};
  return shapes.at(static_cast<size_t>(style));
}

/// Height of the outline at x, straight between its points.
double TopAt(const CarShape& shape, double x) {
  for (size_t i = 1; i < shape.top.size(); ++i) {
    const auto& [x0, z0] = shape.top[i - 1];
    const auto& [x1, z1] = shape.top[i];
    if (x <= x1) return z0 + (z1 - z0) * (x - x0) / (x1 - x0);
  }
  return shape.top.back()[1];
}

/// Cross-sections: dense, with one close to each side of every corner of the
/// outline, which rounds it.
std::vector<double> Stations(const CarShape& shape) {
  std::vector<double> stations;
  for (const auto& [x, z] : shape.top)
    for (const double side : {-0.04, 0.0, 0.04})
      stations.push_back(std::clamp(x + side, 0.0, shape.length));
  for (double x = 0.3; x < shape.length - 0.2; x += 0.3) stations.push_back(x);
  std::sort(stations.begin(), stations.end());
  std::vector<double> spaced = {stations.front()};
  for (const double x : stations)
    if (x - spaced.back() > 0.025) spaced.push_back(x);
  return spaced;
}

constexpr int kSectionPoints = 11;

/// Right sill, over the roof, to the left sill.
Eigen::Vector3d SectionPoint(const CarShape& shape, double x, int point) {
  const double top = (TopAt(shape, x - 0.04) + TopAt(shape, x) + TopAt(shape, x + 0.04)) / 3;
  const double along = 2 * x / shape.length - 1;
  const double width =
      shape.half_width * (1 - 0.10 * std::pow(std::abs(along), 6) - 0.03 * along * along);
  const double belt = std::min(shape.belt, top - 0.05);
  const double cabin = std::clamp((top - shape.belt) / 0.45, 0.0, 1.0);
  const double shoulder = width * (0.97 - 0.17 * cabin);
  const std::array<Eigen::Vector2d, 6> right = {{{0.93 * width, 0.20},
                                                 {width, 0.34},
                                                 {width, 0.62 * belt + 0.1},
                                                 {0.975 * width, belt},
                                                 {shoulder, top - 0.045 - 0.02 * cabin},
                                                 {0, top}}};
  const int mirrored = std::min(point, kSectionPoints - 1 - point);
  const Eigen::Vector2d& flat = right[static_cast<size_t>(mirrored)];
  return Eigen::Vector3d(x - shape.length / 2, point <= 5 ? -flat.x() : flat.x(), flat.y());
}

struct CarMaterials {
  MaterialId paint, glass, rubber, rim, dark, plate, lamp, tail;
};

CarMaterials ChooseMaterials(Random& random, std::vector<Material>& materials) {
  static const std::array<Color, 10> paints = {
      {Gray(0.72f), Gray(0.55f), Gray(0.30f), Gray(0.045f), Gray(0.10f), Rgb(0.05f, 0.11f, 0.32f),
       Rgb(0.42f, 0.04f, 0.03f), Rgb(0.08f, 0.20f, 0.12f), Rgb(0.45f, 0.38f, 0.26f),
       Rgb(0.16f, 0.30f, 0.46f)}};
  const auto add = [&](Material material) {
    material.surface = SurfaceClass::kVehicle;
    materials.push_back(material);
    return static_cast<MaterialId>(materials.size() - 1);
  };
  CarMaterials chosen{};
  const Color paint =
      paints[static_cast<size_t>(random.Index(10))] * static_cast<float>(random.Uniform(0.8, 1.15));
  chosen.paint = add({.albedo = paint,
                      .mirror = 0.05f,
                      .texture = TextureKind::kPlaster,
                      .texture_size = 1.7f,
                      .texture_contrast = 0.04f});
  chosen.glass = add({.albedo = Gray(0.025f), .mirror = 0.10f});
  chosen.rubber = add({.albedo = Gray(0.03f)});
  chosen.rim = add({.albedo = Gray(static_cast<float>(random.Uniform(0.2, 0.5))), .mirror = 0.1f});
  chosen.dark = add({.albedo = Gray(0.04f), .mirror = 0.02f});
  chosen.plate = add({.albedo = Rgb(0.75f, 0.74f, 0.68f)});
  chosen.lamp = add({.albedo = Gray(0.62f), .mirror = 0.12f});
  chosen.tail = add({.albedo = Rgb(0.45f, 0.03f, 0.02f), .mirror = 0.08f});
  return chosen;
}

void AddBody(Mesh& mesh, const CarShape& shape, const CarMaterials& materials) {
  const std::vector<double> stations = Stations(shape);
  const int columns = static_cast<int>(stations.size());
  const auto position = [&](int i, int j) {
    return SectionPoint(shape, stations[static_cast<size_t>(i)], j);
  };
  const double pillar = shape.length * 0.48;
  const auto material = [&](int i, int j) {
    const double x0 = stations[static_cast<size_t>(i)], x1 = stations[static_cast<size_t>(i) + 1];
    const double z0 = TopAt(shape, x0), z1 = TopAt(shape, x1);
    const bool is_cabin = std::min(z0, z1) > shape.belt + 0.12;
    const bool is_side_window = is_cabin && (j == 3 || j == 6) && !(x0 < pillar && pillar < x1);
    const bool is_screen = is_cabin && (j == 4 || j == 5) && std::abs(z1 - z0) > 0.35 * (x1 - x0);
    if (j == 0 || j == 9) return materials.dark;
    return is_side_window || is_screen ? materials.glass : materials.paint;
  };
  mesh.AddSheet(columns, kSectionPoints, position, material);
  for (const int end : {0, columns - 1}) {
    for (int j = 0; j < 5; ++j) {
      const int other = kSectionPoints - 1 - j;
      const std::array<Eigen::Vector3d, 4> face = {position(end, other), position(end, j),
                                                   position(end, j + 1), position(end, other - 1)};
      const std::array<Eigen::Vector3d, 4> reversed = {face[3], face[2], face[1], face[0]};
      mesh.AddQuad(end == 0 ? face : reversed, j < 2 ? materials.dark : materials.paint);
    }
  }
}

void AddWheels(Mesh& mesh, const CarShape& shape, const CarMaterials& materials) {
  for (const double x : {shape.rear_overhang, shape.rear_overhang + shape.wheelbase}) {
    for (const double side : {-1.0, 1.0}) {
      const auto disc = [&](double radius, double from, double to, MaterialId material, int sides) {
        const Eigen::Vector3d center(x - shape.length / 2, 0, shape.wheel_radius);
        mesh.AddCylinder(center + side * from * Eigen::Vector3d::UnitY(),
                         center + side * to * Eigen::Vector3d::UnitY(), radius, radius, material,
                         sides);
      };
      const double face = shape.half_width;
      disc(shape.wheel_radius + 0.06, face - 0.15, face - 0.004, materials.dark, 20);
      disc(shape.wheel_radius, face - 0.22, face + 0.012, materials.rubber, 20);
      disc(shape.wheel_radius * 0.66, face - 0.1, face + 0.018, materials.rim, 16);
      disc(shape.wheel_radius * 0.18, face - 0.1, face + 0.026, materials.dark, 8);
    }
  }
}

/// Lamps, plates, grille, door gaps and handles, mirrors.
void AddTrim(Mesh& mesh, const CarShape& shape, const CarMaterials& materials, Random& random) {
  const double nose = shape.length / 2, width = shape.half_width;
  const auto box = [&](double x, double y, double z, double dx, double dy, double dz,
                       MaterialId material) {
    mesh.AddBox({x, y, z}, {dx, dy, dz}, 0, material);
  };
  for (const double side : {-1.0, 1.0}) {
    box(nose - 0.12, side * 0.72 * width, 0.66, 0.09, 0.16, 0.055, materials.lamp);
    box(-nose + 0.04, side * 0.78 * width, 0.86, 0.055, 0.10, 0.12, materials.tail);
    const double screen = shape.rear_overhang + shape.wheelbase - nose - 0.62;
    box(screen, side * (width + 0.09), shape.belt + 0.07, 0.05, 0.09, 0.07, materials.dark);
    for (const double x : {0.55, -0.45}) {
      box(screen + x - 0.55, side * (width - 0.002), 0.62 * shape.belt, 0.006, 0.006, 0.28,
          materials.dark);
      box(screen + x - 0.75, side * (width + 0.005), shape.belt - 0.12, 0.08, 0.015, 0.014,
          materials.rim);
    }
    box(0, side * (width - 0.004), 0.26, 0.28 * shape.length, 0.012, 0.05, materials.dark);
  }
  box(nose - 0.03, 0, 0.52, 0.045, 0.40, 0.07, materials.dark);
  for (const double end : {nose - 0.005, -nose + 0.0}) {
    const double z = end > 0 ? 0.42 : 0.66;
    box(end, 0, z, 0.025, 0.26, 0.055, materials.plate);
    for (int letter = 0; letter < 7; ++letter)
      if (random.Chance(0.8))
        box(end, -0.21 + 0.07 * letter, z + random.Uniform(-0.008, 0.008), 0.028,
            random.Uniform(0.01, 0.022), random.Uniform(0.02, 0.036), materials.dark);
  }
}

}  // namespace

Mesh MakeCar(int style, std::uint64_t seed, std::vector<Material>& materials) {
  Random random(seed, 0xca2);
  const CarShape& shape = ShapeOf(style);
  const CarMaterials chosen = ChooseMaterials(random, materials);
  Mesh mesh;
  AddBody(mesh, shape, chosen);
  AddWheels(mesh, shape, chosen);
  AddTrim(mesh, shape, chosen, random);
  return mesh;
}

double RearAxleX(int style) { return ShapeOf(style).rear_overhang - ShapeOf(style).length / 2; }
double Wheelbase(int style) { return ShapeOf(style).wheelbase; }

}  // namespace parkade::simulator
