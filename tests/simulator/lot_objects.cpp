#include "tests/simulator/lot_objects.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/buildings.h"
#include "tests/simulator/car_mesh.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kKerbHeight = 0.12, kKerbWidth = 0.15;  // [m]
constexpr double kHorizon = 160;                         // [m] of green around the lot

class LotFurnisher {
 public:
  LotFurnisher(const LotLayout& layout, const Ground& ground, std::uint64_t seed, std::vector<Material>& materials)
      : layout_(layout), ground_(ground), random_(seed, 0x0b1), materials_(materials) {
    for (const float tone : {0.24f, 0.30f, 0.36f})
      kerb_.push_back(Add(
          {.albedo = Gray(tone), .texture = TextureKind::kPlaster, .texture_size = 0.7f, .texture_contrast = 0.12f}));
    grass_ = Add({.albedo = Rgb(0.10f, 0.15f, 0.045f),
                  .texture = TextureKind::kGrass,
                  .texture_size = 2.3f,
                  .texture_contrast = 0.35f});
    bark_ = Add({.albedo = Rgb(0.13f, 0.10f, 0.075f),
                 .texture = TextureKind::kBark,
                 .texture_size = 0.9f,
                 .texture_contrast = 0.35f});
    for (const Color& color : {Rgb(0.07f, 0.13f, 0.03f), Rgb(0.11f, 0.15f, 0.035f), Rgb(0.05f, 0.10f, 0.035f)})
      leaves_.push_back(
          Add({.albedo = color, .texture = TextureKind::kLeaves, .texture_size = 1.9f, .texture_contrast = 0.55f}));
    metal_ = Add({.albedo = Gray(0.32f), .mirror = 0.06f});
    white_ = Add({.albedo = Gray(0.7f)});
    blue_ = Add({.albedo = Rgb(0.03f, 0.12f, 0.42f)});
    red_ = Add({.albedo = Rgb(0.5f, 0.05f, 0.04f)});
    wood_ = Add({.albedo = Rgb(0.25f, 0.17f, 0.10f),
                 .texture = TextureKind::kBark,
                 .texture_size = 1.3f,
                 .texture_contrast = 0.25f});
  }

  void Green() {
    const auto lines = [](double length) {
      std::vector<double> places;
      for (double x = -kHorizon; x < 0; x += x < -20 ? 5 : 1) places.push_back(std::min(x, 0.0));
      const int num_inside = static_cast<int>(length) + 1;
      for (int i = 0; i < num_inside; ++i) places.push_back(length * i / num_inside);
      for (double x = 0; x < kHorizon; x += x < 20 ? 1 : 5) places.push_back(length + x);
      return places;
    };
    const std::vector<double> xs = lines(layout_.length), ys = lines(layout_.width);
    for (size_t j = 0; j + 1 < ys.size(); ++j) {
      for (size_t i = 0; i + 1 < xs.size(); ++i) {
        const Vector2d middle((xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2);
        if (middle.x() > 0 && middle.y() > 0 && middle.x() < layout_.length && middle.y() < layout_.width) continue;
        mesh_.AddQuad({OnGreen(xs[i], ys[j]), OnGreen(xs[i + 1], ys[j]), OnGreen(xs[i + 1], ys[j + 1]),
                       OnGreen(xs[i], ys[j + 1])},
                      grass_);
      }
    }
  }

  void KerbAround(const Rectangle& rectangle, bool is_inside_out) {
    for (int side = 0; side < 4; ++side) {
      Vector2d from = rectangle.Corner(side), to = rectangle.Corner((side + 1) % 4);
      if (is_inside_out) std::swap(from, to);
      Kerb(from, to);
    }
  }

  void Islands() {
    for (const Rectangle& island : layout_.islands) {
      KerbAround(island, false);
      const int rows = 2 + static_cast<int>(2 * island.half_size.y());
      const Vector2d low = island.center - island.half_size, size = 2 * island.half_size;
      mesh_.AddSheet(
          2, rows, [&](int i, int j) { return OnGreen(low.x() + size.x() * i, low.y() + size.y() * j / (rows - 1)); },
          [&](int, int) { return grass_; });
      if (island.half_size.y() > 2) {
        for (const double y : {-0.6, 0.55})
          Tree(island.center + Vector2d(0, y * island.half_size.y()), random_.Uniform(4, 6));
        Lamp(island.center);
        for (int i = 0; i < 5; ++i)
          Bush(island.center + Vector2d(random_.Uniform(-0.4, 0.4), random_.Uniform(-0.9, 0.9) * island.half_size.y()),
               random_.Uniform(0.25, 0.5));
      } else {
        random_.Chance(0.5) ? Lamp(island.center) : Tree(island.center, random_.Uniform(3.5, 5));
      }
    }
  }

  void Cars() {
    for (const ParkedCar& car : layout_.cars) {
      const Vector2d& center = car.footprint.center;
      // Each car stands on the plane that touches the ground under its middle.
      const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), ground_.Normal(center, 0));
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(car.footprint.yaw, Vector3d::UnitZ()));
      mesh_.Append(MakeCar(car.style, car.seed, materials_), {tilt * turn, OnGround(center.x(), center.y(), 0)});
    }
  }

  void Surroundings() {
    const double length = layout_.length, width = layout_.width;
    const bool hedge_in_south = random_.Chance(0.5);
    Hedge({1, hedge_in_south ? -1.4 : width + 1.4}, {length - 1, hedge_in_south ? -1.4 : width + 1.4});
    Fence({-1, hedge_in_south ? width + 1.2 : -1.2}, {length + 1, hedge_in_south ? width + 1.2 : -1.2});
    for (const double y : {-4.5, width + 4.5})
      for (double x = random_.Uniform(-4, 4); x < length + 5; x += random_.Uniform(5, 13))
        Tree({x, y + random_.Uniform(-1, 1)}, random_.Uniform(4.5, 8));
    for (const double x : {-3.5, length + 3.5}) {
      for (double y = random_.Uniform(0, 4); y < width; y += random_.Uniform(4, 9)) {
        const int kind = random_.Index(4);
        if (kind == 0) Tree({x, y}, random_.Uniform(4, 7));
        if (kind == 1) Bush({x, y}, random_.Uniform(0.5, 1.1));
        if (kind == 2) Sign({x > 0 ? length + 0.6 : -0.6, y}, x > 0 ? M_PI : 0);
        if (kind == 3)
          mesh_.AddBox(OnGround(x, y, 0.65), {0.35, 0.3, 0.65}, random_.Uniform(0, 1),
                       random_.Chance(0.5) ? metal_ : leaves_[2]);
      }
      for (double y = 1; y < width; y += random_.Uniform(1.4, 1.8)) Bollard({x > 0 ? length + 0.4 : -0.4, y});
    }
    for (double x = 12; x < length - 10; x += random_.Uniform(9, 16)) {
      Sign({x, -0.5}, M_PI / 2);
      Sign({x + 3, width + 0.5}, -M_PI / 2);
    }
  }

  void Town() {
    const Vector2d middle(layout_.length / 2, layout_.width / 2);
    for (int side = 0; side < 4; ++side) {
      const Vector2d out = side == 0   ? Vector2d(0, -1)
                           : side == 1 ? Vector2d(1, 0)
                           : side == 2 ? Vector2d(0, 1)
                                       : Vector2d(-1, 0);
      const Vector2d along(-out.y(), out.x());
      const double reach = std::abs(out.dot(middle)), span = std::abs(along.dot(middle)) + 12;
      for (double place = -span; place < span;) {
        const double half_front = random_.Uniform(5, 13), half_depth = random_.Uniform(4, 8),
                     gap = random_.Uniform(1.5, 9);
        Building(middle + out * (reach + random_.Uniform(7.5, 13) + half_depth) + along * (place + half_front),
                 half_front, half_depth, along, random_.Uniform(3.6, 12), true);
        place += 2 * half_front + gap;
      }
      for (double place = -span - 60; place < span + 60;) {
        const double half_front = random_.Uniform(6, 18);
        Building(middle + out * (reach + random_.Uniform(45, 90)) + along * (place + half_front), half_front, 6, along,
                 random_.Uniform(10, 32), false);
        place += 2 * half_front + random_.Uniform(2, 14);
      }
    }
  }

  Mesh Take() { return std::move(mesh_); }

 private:
  MaterialId Add(const Material& material) {
    materials_.push_back(material);
    return static_cast<MaterialId>(materials_.size() - 1);
  }

  Vector3d OnGround(double x, double y, double above) const { return {x, y, ground_.Height({x, y}, 0) + above}; }
  Vector3d OnGreen(double x, double y) const { return OnGround(x, y, kKerbHeight - 0.02); }

  /// Kerb stones of about a metre, each of its own grey; the road is on the right of from -> to.
  void Kerb(const Vector2d& from, const Vector2d& to) {
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
      const double top = kKerbHeight - sink, inner = -kKerbWidth;
      mesh_.AddQuad({at(a, 0, top), at(a, 0, -0.1), at(b, 0, -0.1), at(b, 0, top)}, stone);
      mesh_.AddQuad({at(a, inner, top), at(a, 0, top), at(b, 0, top), at(b, inner, top)}, stone);
    }
  }

  void Tree(const Vector2d& at, double height) {
    const Vector3d foot = OnGround(at.x(), at.y(), 0),
                   crown = foot + Vector3d(random_.Uniform(-0.2, 0.2), random_.Uniform(-0.2, 0.2), 0.62 * height);
    mesh_.AddCylinder(foot - Vector3d(0, 0, 0.2), crown, 0.03 * height, 0.015 * height, bark_, 9);
    const MaterialId leaves = leaves_[static_cast<size_t>(random_.Index(3))];
    const int num_blobs = 6 + random_.Index(5);
    for (int i = 0; i < num_blobs; ++i) {
      const double radius = height * random_.Uniform(0.10, 0.2);
      const Vector3d offset =
          height * Vector3d(random_.Uniform(-0.2, 0.2), random_.Uniform(-0.2, 0.2), random_.Uniform(-0.12, 0.24));
      mesh_.AddBlob(crown + offset, radius * Vector3d(1, 1, random_.Uniform(0.7, 1)), 0.45,
                    static_cast<std::uint32_t>(random_.Bits()), leaves, 10);
      mesh_.AddCylinder(crown - Vector3d(0, 0, 0.1 * height), crown + offset, 0.012 * height, 0.006 * height, bark_, 5);
    }
  }

  void Bush(const Vector2d& at, double radius) {
    mesh_.AddBlob(OnGround(at.x(), at.y(), 0.6 * radius), {radius, radius, 0.9 * radius}, 0.4,
                  static_cast<std::uint32_t>(random_.Bits()), leaves_[static_cast<size_t>(random_.Index(3))], 10);
  }

  void Hedge(const Vector2d& from, const Vector2d& to) {
    const double length = (to - from).norm();
    for (double place = 0; place < length; place += random_.Uniform(0.5, 0.75))
      Bush(from + (to - from) * (place / length), random_.Uniform(0.55, 0.75));
  }

  void Fence(const Vector2d& from, const Vector2d& to) {
    const double length = (to - from).norm(), yaw = std::atan2(to.y() - from.y(), to.x() - from.x());
    const Vector2d along = (to - from) / length;
    for (double place = 0; place < length; place += 2) {
      const Vector2d at = from + place * along, middle = at + along;
      mesh_.AddBox(OnGround(at.x(), at.y(), 0.55), {0.05, 0.05, 0.6}, yaw, wood_);
      for (const double z : {0.35, 0.7, 1.0})
        mesh_.AddBox(OnGround(middle.x(), middle.y(), z + random_.Uniform(-0.02, 0.02)), {1.0, 0.02, 0.07}, yaw, wood_);
    }
  }

  void Lamp(const Vector2d& at) {
    const Vector3d foot = OnGround(at.x(), at.y(), 0), top = foot + Vector3d(0, 0, 6);
    mesh_.AddCylinder(foot, top, 0.09, 0.05, metal_, 10);
    mesh_.AddBox(foot + Vector3d(0, 0, 0.25), {0.16, 0.16, 0.25}, 0, kerb_[0]);
    mesh_.AddBox(top + Vector3d(0, 0, 0.05), {0.7, 0.12, 0.05}, random_.Uniform(0, M_PI), metal_);
  }

  void Bollard(const Vector2d& at) {
    const Vector3d foot = OnGround(at.x(), at.y(), 0);
    mesh_.AddCylinder(foot, foot + Vector3d(0, 0, 0.9), 0.06, 0.06, metal_, 10);
    mesh_.AddCylinder(foot + Vector3d(0, 0, 0.7), foot + Vector3d(0, 0, 0.8), 0.063, 0.063,
                      random_.Chance(0.5) ? white_ : red_, 10);
  }

  /// A sign on a pole facing `yaw`, with a pattern of its own.
  void Sign(const Vector2d& at, double yaw) {
    const Vector3d foot = OnGround(at.x(), at.y(), 0), front(std::cos(yaw), std::sin(yaw), 0),
                   left(-front.y(), front.x(), 0);
    mesh_.AddCylinder(foot, foot + Vector3d(0, 0, 2.3), 0.03, 0.03, metal_, 8);
    const Vector3d board = foot + 0.05 * front + Vector3d(0, 0, 2.0);
    const bool is_blue = random_.Chance(0.5);
    mesh_.AddBox(board, {0.012, 0.3, 0.3}, yaw, is_blue ? blue_ : white_);
    for (int i = 0; i < 7; ++i) {
      const Vector3d offset = left * random_.Uniform(-0.22, 0.22) + Vector3d(0, 0, random_.Uniform(-0.22, 0.22));
      mesh_.AddBox(board + 0.004 * front + offset, {0.012, random_.Uniform(0.015, 0.07), random_.Uniform(0.015, 0.07)},
                   yaw,
                   is_blue               ? white_
                   : random_.Chance(0.5) ? red_
                                         : blue_);
    }
  }

  void Building(const Vector2d& center, double half_front, double half_depth, const Vector2d& along, double height,
                bool is_detailed) {
    BuildingPlan plan{center, {half_front, half_depth}};
    plan.yaw = std::atan2(along.y(), along.x()) + random_.Uniform(-0.06, 0.06);
    plan.base = ground_.Height(center, 0);
    plan.height = height;
    plan.is_detailed = is_detailed;
    AddBuilding(plan, random_, mesh_, materials_);
  }

  const LotLayout& layout_;
  const Ground& ground_;
  Random random_;
  std::vector<Material>& materials_;
  Mesh mesh_;
  std::vector<MaterialId> kerb_, leaves_;
  MaterialId grass_ = 0, bark_ = 0, metal_ = 0, white_ = 0, blue_ = 0, red_ = 0, wood_ = 0;
};

}  // namespace

Mesh MakeLotObjects(const LotLayout& layout, const Ground& ground, std::uint64_t seed,
                    std::vector<Material>& materials) {
  LotFurnisher furnisher(layout, ground, seed, materials);
  furnisher.Green();
  const Vector2d half(layout.length / 2, layout.width / 2);
  furnisher.KerbAround({half, half, 0}, true);
  furnisher.Islands();
  furnisher.Cars();
  furnisher.Surroundings();
  furnisher.Town();
  return furnisher.Take();
}

}  // namespace parkade::simulator
