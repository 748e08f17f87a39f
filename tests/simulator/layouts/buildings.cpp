#include "tests/simulator/layouts/buildings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/simulator/common/rectangle.h"

namespace parkade::simulator {
namespace {

struct FacadeMaterials {
  MaterialId wall, base, frame, door, roof;
  std::array<MaterialId, 5> panes;
};

MaterialId AddMaterial(std::vector<Material>& materials, const Material& material) {
  materials.push_back(material);
  return static_cast<MaterialId>(materials.size() - 1);
}

FacadeMaterials ChooseMaterials(Random& random, bool is_lit, std::vector<Material>& materials) {
  static const std::array<Color, 6> tones = {{Rgb(0.42f, 0.20f, 0.14f), Rgb(0.62f, 0.57f, 0.47f),
                                              Rgb(0.55f, 0.56f, 0.55f), Rgb(0.50f, 0.38f, 0.24f),
                                              Rgb(0.30f, 0.30f, 0.31f), Rgb(0.66f, 0.62f, 0.58f)}};
  const int tone = random.Index(6);
  const bool is_brick = tone == 0 || tone == 3 || random.Chance(0.3);
  const Color color = tones[static_cast<size_t>(tone)];
  FacadeMaterials chosen{};
  chosen.wall =
      AddMaterial(materials, {.albedo = color,
                              .texture = is_brick ? TextureKind::kBrick : TextureKind::kPlaster,
                              .texture_size = is_brick ? 1.6f : 6.3f,
                              .texture_contrast = is_brick ? 0.17f : 0.09f});
  chosen.base = AddMaterial(materials, {.albedo = Gray(0.23f),
                                        .texture = TextureKind::kPlaster,
                                        .texture_size = 2.1f,
                                        .texture_contrast = 0.2f});
  chosen.frame = AddMaterial(materials, {.albedo = random.Chance(0.6) ? Gray(0.70f) : Gray(0.12f)});
  chosen.door = AddMaterial(materials, {.albedo = Rgb(0.12f, 0.16f, 0.14f), .mirror = 0.03f});
  chosen.roof = AddMaterial(materials, {.albedo = Gray(0.15f)});
  for (size_t i = 0; i < chosen.panes.size(); ++i) {
    const float tone = static_cast<float>(random.Uniform(0.015, 0.09));
    const Color glow = is_lit && i < 2 ? Color(Rgb(1.0f, 0.75f, 0.42f) * (4 * tone)) : Gray(0);
    chosen.panes[i] =
        AddMaterial(materials, {.albedo = Gray(tone), .emission = glow, .mirror = 0.09f});
  }
  return chosen;
}

/// One side of a building: its own x runs along the wall, y up, z out of it.
class Facade {
 public:
  Facade(const Eigen::Vector3d& corner, const Eigen::Vector3d& along, Mesh& mesh)
      : corner_(corner), along_(along), out_(along.y(), -along.x(), 0), mesh_(mesh) {}

  /// A rectangle standing `depth` [m] out of the wall, with its edges where it stands out.
  void AddPanel(double x0, double x1, double y0, double y1, double depth, MaterialId material) {
    const auto at = [&](double x, double y, double z) -> Eigen::Vector3d {
      return corner_ + x * along_ + y * Eigen::Vector3d::UnitZ() + z * out_;
    };
    mesh_.AddQuad({at(x0, y0, depth), at(x1, y0, depth), at(x1, y1, depth), at(x0, y1, depth)},
                  material);
    if (depth < 0.02) return;
    mesh_.AddQuad({at(x0, y1, depth), at(x1, y1, depth), at(x1, y1, 0), at(x0, y1, 0)}, material);
    mesh_.AddQuad({at(x0, y0, 0), at(x1, y0, 0), at(x1, y0, depth), at(x0, y0, depth)}, material);
    mesh_.AddQuad({at(x0, y0, 0), at(x0, y0, depth), at(x0, y1, depth), at(x0, y1, 0)}, material);
    mesh_.AddQuad({at(x1, y0, depth), at(x1, y0, 0), at(x1, y1, 0), at(x1, y1, depth)}, material);
  }

  void AddWindow(double x0, double x1, double y0, double y1, const FacadeMaterials& materials,
                 Random& random, bool is_detailed) {
    const MaterialId pane = materials.panes[static_cast<size_t>(random.Index(5))];
    if (is_detailed) {
      AddPanel(x0 - 0.09, x1 + 0.09, y0 - 0.09, y1 + 0.09, 0.05, materials.frame);
      AddPanel(x0 - 0.16, x1 + 0.16, y0 - 0.17, y0 - 0.09, 0.14, materials.base);
    }
    const double depth = is_detailed ? 0.055 : 0.015;
    AddPanel(x0, x1, y0, y1, depth, pane);
    if (!is_detailed) return;
    const double middle = (x0 + x1) / 2;
    if (random.Chance(0.7))
      AddPanel(middle - 0.03, middle + 0.03, y0, y1, depth + 0.004, materials.frame);
    if (random.Chance(0.45))
      AddPanel(x0, x1, y1 - random.Uniform(0.15, 0.9) * (y1 - y0), y1, depth + 0.002,
               materials.frame);
    if (random.Chance(0.2))
      AddPanel(x0 + 0.05, x0 + 0.4, y0, y0 + 0.4, depth + 0.003, materials.door);
  }

 private:
  Eigen::Vector3d corner_, along_, out_;
  Mesh& mesh_;
};

}  // namespace

void AddBuilding(const BuildingPlan& plan, Random& random, Mesh& mesh,
                 std::vector<Material>& materials) {
  const FacadeMaterials chosen = ChooseMaterials(random, plan.is_lit, materials);
  const double bottom = plan.base - 1.5, top = plan.base + plan.height;
  const Eigen::Vector3d half(plan.half_size.x(), plan.half_size.y(), (top - bottom) / 2);
  mesh.AddBox({plan.center.x(), plan.center.y(), top + 0.1},
              half.cwiseProduct(Eigen::Vector3d(1, 1, 0)) + Eigen::Vector3d(0.25, 0.25, 0.1),
              plan.yaw, chosen.roof);

  const double storey = random.Uniform(2.8, 3.6), spacing = random.Uniform(2.1, 3.8);
  const double window_width = spacing * random.Uniform(0.35, 0.62),
               window_height = storey * random.Uniform(0.4, 0.6);
  const Rectangle outline{plan.center, plan.half_size, plan.yaw};
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector2d from = outline.Corner(side), to = outline.Corner((side + 1) % 4);
    const double length = (to - from).norm();
    const Eigen::Vector2d along = (to - from) / length;
    Facade facade({from.x(), from.y(), plan.base}, {along.x(), along.y(), 0}, mesh);
    // In rows, so that the shade under the eaves and at the foot stays there.
    const std::array<double, 5> rows = {bottom, plan.base + 0.1, plan.base + 1.5, top - 0.7, top};
    const int columns = 2 + static_cast<int>(length / 4);
    mesh.AddSheet(
        columns, 5,
        [&](int i, int j) -> Eigen::Vector3d {
          const Eigen::Vector2d at = from + (to - from) * i / (columns - 1.0);
          return {at.x(), at.y(), rows[static_cast<size_t>(j)]};
        },
        [&](int, int) { return chosen.wall; });
    if (plan.is_detailed) facade.AddPanel(0, length, -1.5, 0.55, 0.04, chosen.base);
    const int num_columns = static_cast<int>(length / spacing),
              num_storeys = static_cast<int>((plan.height - 0.6) / storey);
    const double margin = (length - num_columns * spacing) / 2;
    const int door_column = random.Index(std::max(1, num_columns));
    for (int row = 0; row < num_storeys; ++row) {
      for (int column = 0; column < num_columns; ++column) {
        const double x = margin + (column + 0.5) * spacing, y = row * storey + 1.0;
        if (plan.is_detailed && row == 0 && column == door_column)
          facade.AddPanel(x - 0.55, x + 0.55, 0.05, 2.15, 0.06, chosen.door);
        else if (random.Chance(0.93))
          facade.AddWindow(x - window_width / 2, x + window_width / 2, y, y + window_height, chosen,
                           random, plan.is_detailed);
      }
    }
  }
}

}  // namespace parkade::simulator
