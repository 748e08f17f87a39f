#pragma once

#include <vector>

#include "tests/simulator/common/lamp.h"
#include "tests/simulator/common/mesh.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/common/rectangle.h"
#include "tests/simulator/ground/ground.h"
#include "tests/simulator/ground/kerb_stone.h"
#include "tests/simulator/layouts/place_look.h"

namespace parkade::simulator {

/// What an outdoor scene is furnished with: kerbs, plants, lamps, signs, houses. All stand
/// on the ground at their place, which has one level. Collects the mesh, its materials
/// and the lights.
class Props {
 public:
  static constexpr double kKerbWidth = 0.15;  ///< [m]
  static constexpr double kLampFoot = 0.16;   ///< [m] half the width of a street lamp's foot

  /// Keeps references to `ground` and `materials`. `is_dark` lights windows and lamps.
  Props(const Ground& ground, std::uint64_t seed, bool is_dark, const PlaceLook& look,
        std::vector<Material>& materials);

  Eigen::Vector3d OnGround(double x, double y, double above) const;
  /// At the height of a lawn or pavement behind a kerb.
  Eigen::Vector3d OnGreen(double x, double y) const { return OnGround(x, y, kerb_height_ - 0.02); }

  /// Kerb stones of about a meter, each of its own gray; the road is on the right of from -> to.
  void Kerb(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void KerbAround(const Rectangle& rectangle, bool is_inside_out);
  void Tree(const Eigen::Vector2d& at, double height);
  void Bush(const Eigen::Vector2d& at, double radius);
  void Hedge(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void Fence(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void StreetLamp(const Eigen::Vector2d& at);
  void Bollard(const Eigen::Vector2d& at);
  /// A sign on a pole facing `yaw`, with a pattern of its own.
  void Sign(const Eigen::Vector2d& at, double yaw);
  void Bin(const Eigen::Vector2d& at);
  /// A heap of shoveled snow, the ellipse in `outline`.
  void Heap(const Rectangle& outline);
  void Building(const Rectangle& outline, double height, bool is_detailed);
  /// A car in the middle of `footprint`, on the plane that touches the ground there near `near_z`.
  void Car(const Rectangle& footprint, double near_z, int style, std::uint64_t seed);

  MaterialId Add(const Material& material);
  MaterialId island() const { return island_; }
  MaterialId land() const { return land_; }
  MaterialId pavement() const { return pavement_; }
  Random& random() { return random_; }
  Mesh& mesh() { return mesh_; }
  std::vector<Lamp>& lamps() { return lamps_; }
  std::vector<KerbStone>& kerbs() { return kerbs_; }

 private:
  const Ground& ground_;
  Random random_;
  bool is_dark_;
  double kerb_height_;  // [m]
  std::vector<Material>& materials_;
  Mesh mesh_;
  std::vector<Lamp> lamps_;
  std::vector<KerbStone> kerbs_;
  std::vector<MaterialId> kerb_, leaves_;
  MaterialId land_ = 0, island_ = 0, pavement_ = 0, bark_ = 0, metal_ = 0, white_ = 0, blue_ = 0,
             red_ = 0, wood_ = 0, lamp_ = 0, snow_ = 0;
};

}  // namespace parkade::simulator
