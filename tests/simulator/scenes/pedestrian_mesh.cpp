#include "tests/simulator/scenes/pedestrian_mesh.h"

#include <cmath>

namespace parkade::simulator {

using Eigen::Vector3d;

namespace {

constexpr double kHip = 0.88;  // [m]

Color Cloth(Random& random) {
  const float red = static_cast<float>(random.Uniform(0.03, 0.4)),
              green = static_cast<float>(random.Uniform(0.03, 0.3)),
              blue = static_cast<float>(random.Uniform(0.03, 0.4));
  return Rgb(red, green, blue);
}

}  // namespace

void AddPedestrian(Random& random, const std::function<Rigid3(double)>& pose, double speed,
                   Movers& movers, std::vector<Material>& materials) {
  const auto add = [&](const Color& color) {
    materials.push_back({.albedo = color,
                         .texture = TextureKind::kPlaster,
                         .texture_size = 0.6f,
                         .texture_contrast = 0.25f,
                         .surface = SurfaceClass::kPerson});
    return static_cast<MaterialId>(materials.size() - 1);
  };
  const MaterialId coat = add(Cloth(random)), trousers = add(0.5f * Cloth(random)),
                   skin = add(Rgb(0.42f, 0.28f, 0.2f)), hair = add(Rgb(0.07f, 0.05f, 0.03f));
  const std::uint32_t seed = static_cast<std::uint32_t>(random.Bits());
  Mesh trunk;
  trunk.AddBlob({0, 0, 1.15}, {0.15, 0.23, 0.34}, 0.15, seed, coat, 10);
  trunk.AddBlob({0.01, 0, 1.62}, {0.1, 0.085, 0.13}, 0.05, seed, skin, 8);
  trunk.AddBlob({-0.02, 0, 1.66}, {0.11, 0.095, 0.12}, 0.1, seed, hair, 8);
  for (const double side : {-1.0, 1.0}) {
    trunk.AddCylinder({0.0, 0.24 * side, 1.38}, {0.04, 0.28 * side, 1.08}, 0.055, 0.05, coat, 8);
    trunk.AddCylinder({0.04, 0.28 * side, 1.08}, {0.12, 0.26 * side, 0.84}, 0.05, 0.04, coat, 8);
    trunk.AddBlob({0.14, 0.26 * side, 0.79}, {0.05, 0.035, 0.06}, 0.1, seed, skin, 6);
  }
  Mesh leg;  // hangs from its origin
  leg.AddCylinder({0, 0, 0.06}, {0.01, 0, -0.45}, 0.1, 0.07, trousers, 8);
  leg.AddCylinder({0.01, 0, -0.45}, {-0.02, 0, -0.84}, 0.07, 0.055, trousers, 8);
  leg.AddBox({0.06, 0, -0.845}, {0.13, 0.05, 0.035}, 0, hair);
  movers.shapes.push_back(std::move(trunk));
  movers.shapes.push_back(std::move(leg));
  const size_t trunk_shape = movers.shapes.size() - 2;
  movers.movers.push_back({trunk_shape, pose, {0.25f, 0.25f}});
  const double pace = 2 * M_PI * speed / 1.45,
               phase = random.Uniform(0, 2 * M_PI);  // a double step is 1.45 m
  for (const double side : {-1.0, 1.0})
    movers.movers.push_back({trunk_shape + 1,
                             [=](double time) {
                               const double swing = 0.45 * side * std::sin(pace * time + phase);
                               const Rigid3 body_from_leg{
                                   Eigen::Quaterniond(Eigen::AngleAxisd(swing, Vector3d::UnitY())),
                                   {0, 0.09 * side, kHip}};
                               return pose(time) * body_from_leg;
                             },
                             {0, 0}});
}

}  // namespace parkade::simulator
