#include "tests/simulator/layouts/props.h"

#include <algorithm>
#include <cmath>

#include "core/math/decompositions.h"
#include "tests/simulator/layouts/buildings.h"
#include "tests/simulator/vehicle/car_mesh.h"

namespace parkade::simulator {

using Eigen::Vector2d;
using Eigen::Vector3d;

Props::Props(const Ground& ground, std::uint64_t seed, bool is_dark, const PlaceLook& look,
             std::vector<Material>& materials)
    : ground_(ground),
      random_(seed, 0x0b1),
      is_dark_(is_dark),
      kerb_height_(look.kerb_height),
      materials_(materials) {
  for (const Material& stone : look.kerbs) kerb_.push_back(Add(stone));
  land_ = Add(look.land);
  island_ = Add(look.island);
  bark_ = Add({.albedo = Rgb(0.13f, 0.10f, 0.075f),
               .texture = TextureKind::kBark,
               .texture_size = 0.9f,
               .texture_contrast = 0.35f,
               .surface = SurfaceClass::kVegetation});
  for (const Color& color :
       {Rgb(0.07f, 0.13f, 0.03f), Rgb(0.11f, 0.15f, 0.035f), Rgb(0.05f, 0.10f, 0.035f)})
    leaves_.push_back(Add({.albedo = color,
                           .texture = TextureKind::kLeaves,
                           .texture_size = 1.9f,
                           .texture_contrast = 0.55f,
                           .surface = SurfaceClass::kVegetation}));
  metal_ = Add({.albedo = Gray(0.32f), .mirror = 0.06f});
  white_ = Add({.albedo = Gray(0.7f)});
  blue_ = Add({.albedo = Rgb(0.03f, 0.12f, 0.42f)});
  red_ = Add({.albedo = Rgb(0.5f, 0.05f, 0.04f)});
  wood_ = Add({.albedo = Rgb(0.25f, 0.17f, 0.10f),
               .texture = TextureKind::kBark,
               .texture_size = 1.3f,
               .texture_contrast = 0.25f});
  pavement_ = Add(look.pavement);
  snow_ = Add({.albedo = Rgb(0.66f, 0.67f, 0.7f),
               .texture = TextureKind::kPlaster,
               .texture_size = 1.1f,
               .texture_contrast = 0.1f});
  lamp_ = Add({.albedo = Gray(0.7f), .emission = is_dark ? Rgb(6, 4.8f, 3) : Gray(0)});
}

MaterialId Props::Add(const Material& material) {
  materials_.push_back(material);
  return static_cast<MaterialId>(materials_.size() - 1);
}

Vector3d Props::OnGround(double x, double y, double above) const {
  return {x, y, ground_.Height({x, y}, 0) + above};
}

void Props::Kerb(const Vector2d& from, const Vector2d& to) {
  const double length = (to - from).norm();
  const Vector2d along = (to - from) / length, right(along.y(), -along.x());
  const int num_stones = std::max(1, static_cast<int>(length));
  for (int i = 0; i < num_stones; ++i) {
    const MaterialId stone = kerb_[static_cast<size_t>(random_.Index(3))];
    const double sink = random_.Uniform(0, 0.012), joint = 0.006;
    const Vector2d a = from + along * (length * i / num_stones + joint),
                   b = from + along * (length * (i + 1) / num_stones - joint);
    const auto at = [&](const Vector2d& point, double outward, double above) {
      const Vector2d moved = point + outward * right;
      return OnGround(moved.x(), moved.y(), above);
    };
    const double top = kerb_height_ - sink, inner = -kKerbWidth;
    kerbs_.push_back({at(b, 0, 0), at(a, 0, 0), top});
    mesh_.AddQuad({at(a, 0, top), at(a, 0, -0.1), at(b, 0, -0.1), at(b, 0, top)}, stone);
    mesh_.AddQuad({at(a, inner, top), at(a, 0, top), at(b, 0, top), at(b, inner, top)}, stone);
  }
}

void Props::Tree(const Vector2d& at, double height) {
  const Vector3d foot = OnGround(at.x(), at.y(), 0),
                 crown = foot + Vector3d(random_.Uniform(-0.2, 0.2), random_.Uniform(-0.2, 0.2),
                                         0.62 * height);
  mesh_.AddCylinder(foot - Vector3d(0, 0, 0.2), crown, 0.03 * height, 0.015 * height, bark_, 9);
  const MaterialId leaves = leaves_[static_cast<size_t>(random_.Index(3))];
  const int num_blobs = 6 + random_.Index(5);
  for (int i = 0; i < num_blobs; ++i) {
    const double radius = height * random_.Uniform(0.10, 0.2);
    const Vector3d offset =
        height * Vector3d(random_.Uniform(-0.2, 0.2), random_.Uniform(-0.2, 0.2),
                          random_.Uniform(-0.12, 0.24));
    mesh_.AddBlob(crown + offset, radius * Vector3d(1, 1, random_.Uniform(0.7, 1)), 0.45,
                  static_cast<std::uint32_t>(random_.Bits()), leaves, 10);
    mesh_.AddCylinder(crown - Vector3d(0, 0, 0.1 * height), crown + offset, 0.012 * height,
                      0.006 * height, bark_, 5);
  }
}

void Props::Bush(const Vector2d& at, double radius) {
  mesh_.AddBlob(OnGround(at.x(), at.y(), 0.6 * radius), {radius, radius, 0.9 * radius}, 0.4,
                static_cast<std::uint32_t>(random_.Bits()),
                leaves_[static_cast<size_t>(random_.Index(3))], 10);
}

void Props::Hedge(const Vector2d& from, const Vector2d& to) {
  const double length = (to - from).norm();
  for (double place = 0; place < length; place += random_.Uniform(0.5, 0.75))
    Bush(from + (to - from) * (place / length), random_.Uniform(0.55, 0.75));
}

void Props::Fence(const Vector2d& from, const Vector2d& to) {
  const double length = (to - from).norm(), yaw = std::atan2(to.y() - from.y(), to.x() - from.x());
  const Vector2d along = (to - from) / length;
  for (double place = 0; place < length; place += 2) {
    const Vector2d at = from + place * along, middle = at + along;
    mesh_.AddBox(OnGround(at.x(), at.y(), 0.55), {0.05, 0.05, 0.6}, yaw, wood_);
    for (const double z : {0.35, 0.7, 1.0})
      mesh_.AddBox(OnGround(middle.x(), middle.y(), z + random_.Uniform(-0.02, 0.02)),
                   {1.0, 0.02, 0.07}, yaw, wood_);
  }
}

void Props::StreetLamp(const Vector2d& at) {
  const Vector3d foot = OnGround(at.x(), at.y(), 0), top = foot + Vector3d(0, 0, 6);
  mesh_.AddCylinder(foot, top, 0.09, 0.05, metal_, 10);
  mesh_.AddBox(foot + Vector3d(0, 0, 0.25), {kLampFoot, kLampFoot, 0.25}, 0, kerb_[0]);
  const double yaw = random_.Uniform(0, M_PI);
  mesh_.AddBox(top + Vector3d(0, 0, 0.05), {0.7, 0.12, 0.05}, yaw, metal_);
  mesh_.AddBox(top - Vector3d(0, 0, 0.01), {0.6, 0.09, 0.015}, yaw, lamp_);
  const float strength = static_cast<float>(random_.Uniform(7, 10));
  if (is_dark_)
    lamps_.push_back(
        {(top - Vector3d(0, 0, 0.1)).cast<float>(), Rgb(1.0f, 0.78f, 0.48f) * strength});
}

void Props::Bollard(const Vector2d& at) {
  const Vector3d foot = OnGround(at.x(), at.y(), 0);
  mesh_.AddCylinder(foot, foot + Vector3d(0, 0, 0.9), 0.06, 0.06, metal_, 10);
  mesh_.AddCylinder(foot + Vector3d(0, 0, 0.7), foot + Vector3d(0, 0, 0.8), 0.063, 0.063,
                    random_.Chance(0.5) ? white_ : red_, 10);
}

void Props::Sign(const Vector2d& at, double yaw) {
  const Vector3d foot = OnGround(at.x(), at.y(), 0), front(std::cos(yaw), std::sin(yaw), 0),
                 left(-front.y(), front.x(), 0);
  mesh_.AddCylinder(foot, foot + Vector3d(0, 0, 2.3), 0.03, 0.03, metal_, 8);
  const Vector3d board = foot + 0.05 * front + Vector3d(0, 0, 2.0);
  const bool is_blue = random_.Chance(0.5);
  mesh_.AddBox(board, {0.012, 0.3, 0.3}, yaw, is_blue ? blue_ : white_);
  for (int i = 0; i < 7; ++i) {
    const Vector3d offset =
        left * random_.Uniform(-0.22, 0.22) + Vector3d(0, 0, random_.Uniform(-0.22, 0.22));
    mesh_.AddBox(board + 0.004 * front + offset,
                 {0.012, random_.Uniform(0.015, 0.07), random_.Uniform(0.015, 0.07)}, yaw,
                 is_blue               ? white_
                 : random_.Chance(0.5) ? red_
                                       : blue_);
  }
}

void Props::Bin(const Vector2d& at) {
  mesh_.AddBox(OnGround(at.x(), at.y(), 0.65), {0.35, 0.3, 0.65}, random_.Uniform(0, 1),
               random_.Chance(0.5) ? metal_ : leaves_[2]);
}

void Props::Heap(const Rectangle& outline) {
  const double height = random_.Uniform(0.4, 0.9);
  Mesh heap;
  heap.AddBlob(Vector3d::Zero(), {outline.half_size.x(), outline.half_size.y(), height}, 0.12,
               static_cast<std::uint32_t>(random_.Bits()), snow_, 14);
  mesh_.Append(heap, {Eigen::Quaterniond(Eigen::AngleAxisd(outline.yaw, Vector3d::UnitZ())),
                      OnGround(outline.center.x(), outline.center.y(), 0)});
}

void Props::Building(const Rectangle& outline, double height, bool is_detailed) {
  BuildingPlan plan{outline.center, outline.half_size};
  plan.yaw = outline.yaw;
  plan.base = ground_.Height(outline.center, 0);
  plan.height = height;
  plan.is_detailed = is_detailed;
  plan.is_lit = is_dark_;
  AddBuilding(plan, random_, mesh_, materials_);
}

void Props::Car(const Rectangle& footprint, double near_z, int style, std::uint64_t seed) {
  const Vector2d& center = footprint.center;
  const Eigen::Quaterniond tilt =
      RotationBetween(Vector3d::UnitZ(), ground_.Normal(center, near_z));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(footprint.yaw, Vector3d::UnitZ()));
  mesh_.Append(MakeCar(style, seed, materials_),
               {tilt * turn, {center.x(), center.y(), ground_.Height(center, near_z)}});
}

void Props::KerbAround(const Rectangle& rectangle, bool is_inside_out) {
  for (int side = 0; side < 4; ++side) {
    Vector2d from = rectangle.Corner(side), to = rectangle.Corner((side + 1) % 4);
    if (is_inside_out) std::swap(from, to);
    Kerb(from, to);
  }
}

}  // namespace parkade::simulator
