#include "tests/simulator/scenes/mover_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "tests/simulator/rays/ray_scene.h"

namespace parkade::simulator {
namespace {

constexpr double kSight = 90;  // [m]

/// 3 x 4, by columns, as Embree wants it.
std::array<float, 12> ColumnsOf(const Rigid3& motion) {
  const FastPose pose(motion);
  std::array<float, 12> columns{};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      columns[static_cast<size_t>(3 * column + row)] = pose.rotation(row, column);
  for (int row = 0; row < 3; ++row) columns[static_cast<size_t>(9 + row)] = pose.translation[row];
  return columns;
}

}  // namespace

MoverScene::MoverScene(const Movers& movers) : movers_(movers) {
  device_.reset(rtcNewDevice("threads=1"));
  Require(device_ != nullptr, ErrorCode::kInternal, "the ray tracer did not start");
  for (const Mesh& mesh : movers.shapes) {
    ScenePointer shape(rtcNewScene(device_.get()));
    AttachMesh(device_.get(), shape.get(), mesh, 0);
    rtcCommitScene(shape.get());
    shapes_.push_back(std::move(shape));
  }
}

MoverScene::~MoverScene() = default;

void MoverScene::PlaceAt(double from, double to, const Eigen::Vector3d& eye) {
  placed_.clear();
  top_.reset();
  for (const Mover& mover : movers_.movers) {
    const Rigid3 middle = mover.world_from_mover((from + to) / 2);
    if ((middle.translation - eye).norm() > kSight) continue;
    if (!top_) top_.reset(rtcNewScene(device_.get()));
    const RTCGeometry instance = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, shapes_[mover.shape].get());
    rtcSetGeometryTimeStepCount(instance, 2);
    const std::array<float, 12> first = ColumnsOf(mover.world_from_mover(from)),
                                last = ColumnsOf(mover.world_from_mover(to));
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, first.data());
    rtcSetGeometryTransform(instance, 1, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, last.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(top_.get(), instance, static_cast<unsigned>(placed_.size()));
    rtcReleaseGeometry(instance);
    placed_.push_back({&mover, &movers_.shapes[mover.shape], FastPose(middle)});
  }
  if (top_) rtcCommitScene(top_.get());
}

float MoverScene::Ambient(const Eigen::Vector3f& point) const {
  float ambient = 1;
  for (const Placed& placed : placed_) {
    const Eigen::Vector2f& half = placed.mover->half_size;
    if (half.x() <= 0) continue;
    if ((placed.world_from_mover.translation - point).squaredNorm() > 36) continue;
    const Eigen::Vector3f local = placed.world_from_mover.ToSource(point);
    const Eigen::Vector2f beyond =
        ((local.head<2>() - Eigen::Vector2f(placed.mover->center, 0)).cwiseAbs() - half)
            .cwiseMax(0.0f);
    ambient *=
        1 - 0.75f * std::exp(-(beyond.norm() + std::abs(local.z())) / (0.2f + 0.25f * half.x()));
  }
  return ambient;
}

}  // namespace parkade::simulator
