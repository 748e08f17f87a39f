#pragma once

#include "tests/simulator/common/lamp.h"
#include "tests/simulator/common/mesh.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/layouts/garage_layout.h"

namespace parkade::simulator {

/// Concrete, paint and fittings of a garage; floors excepted. All faces are cut into
/// pieces of less than a meter, so that light varies over them.
class GarageStructure {
 public:
  GarageStructure(const GarageLayout& layout, std::uint64_t seed, std::vector<Material>& materials);

  void Walls();
  void Ceilings(const Ground& ground);
  void Pillars();
  void Rooms();     ///< and walls inside
  void Fittings();  ///< lamps, pipes, signs

  Mesh& mesh() { return mesh_; }
  std::vector<Lamp>& lamps() { return lamps_; }

 private:
  MaterialId Add(const Material& material);
  /// A parallelogram in pieces, seen from the side from which `u` runs right and `v` up.
  void Panel(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
             MaterialId material);
  /// An upright wall 20 cm thick with paint at the foot.
  void Wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double bottom, double top);
  /// A wall with an opening around each place in `gates` along it.
  void WallWithGates(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double bottom,
                     double top, const std::vector<double>& gates);
  void Parapet(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double bottom, double top);
  /// Seen from inside or from outside.
  void HalfCylinder(double radius, bool faces_inward);
  void TubeLamp(const Eigen::Vector3d& at, double yaw);
  void Pipe(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
            MaterialId material);
  void ExitSign(const Eigen::Vector3d& at, double yaw);
  void Poster(const Eigen::Vector3d& at, double yaw);
  void DeckFittings(int deck);
  MaterialId PillarMaterial(double height) const;
  void BayBoard(const Rectangle& pillar, double floor, int number);
  void Room(const Rectangle& core, double floor);
  void RampLamps(int deck);
  /// Paint, scuffs and boards on a wall of a half circle.
  void CurveWall(int deck, bool is_outer);
  /// The same on a wall of a straight ramp.
  void RampWall(int deck, bool is_north);
  /// A place on a wall of a half circle.
  struct CurvePlace {
    int deck = 0;
    bool is_outer = false;
    double angle = 0;   ///< [rad]
    double height = 0;  ///< [m] over the ramp
  };
  /// A box of `half_size` (off the wall, along it, up).
  void AddToCurve(const CurvePlace& place, const Eigen::Vector3d& half_size, MaterialId material);

  const GarageLayout& layout_;
  Random random_;
  std::vector<Material>& materials_;
  Mesh mesh_;
  std::vector<Lamp> lamps_;
  MaterialId concrete_ = 0, paint_ = 0, ceiling_ = 0, yellow_ = 0, black_ = 0, tube_ = 0,
             dead_tube_ = 0, metal_ = 0, red_ = 0, exit_ = 0, white_ = 0, paper_ = 0, rubber_ = 0,
             pipe_ = 0;
};

}  // namespace parkade::simulator
