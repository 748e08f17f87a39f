#include "tests/simulator/rays/ray_scene.h"

#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {

RayScene::RayScene(const std::vector<const Mesh*>& meshes) {
  // One thread builds the tree, so that it is the same tree every time.
  device_.reset(rtcNewDevice("threads=1"));
  Require(device_ != nullptr, ErrorCode::kInternal, "the ray tracer did not start");
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  for (size_t id = 0; id < meshes.size(); ++id)
    if (!meshes[id]->triangles.empty())
      AttachMesh(device_.get(), scene_.get(), *meshes[id], static_cast<unsigned>(id));
  rtcCommitScene(scene_.get());
}

void AttachMesh(RTCDevice device, RTCScene scene, const Mesh& mesh, unsigned id) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Eigen::Vector3f), mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), mesh.triangles.size());
  Require(vertices != nullptr && indices != nullptr, ErrorCode::kInternal,
          "the ray tracer has no memory for the scene");
  std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(Eigen::Vector3f));
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * 3 * sizeof(std::uint32_t));
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

std::vector<float> RayScene::VertexAmbient(const Mesh& mesh, float reach, std::uint64_t seed,
                                           int rounds) const {
  constexpr int kRays = 16;
  constexpr size_t kBlock = 256;
  std::vector<float> ambient(mesh.positions.size());
  ParallelFor((ambient.size() + kBlock - 1) / kBlock, [&](size_t block) {
    const FlushDenormals flush;
    Random random(seed, block);
    const size_t end = std::min(ambient.size(), (block + 1) * kBlock);
    for (size_t vertex = block * kBlock; vertex < end; ++vertex) {
      const Eigen::Vector3f normal = mesh.normals[vertex], u = normal.unitOrthogonal(),
                            v = normal.cross(u);
      const Eigen::Vector3f origin = mesh.positions[vertex] + 0.01f * normal;
      int num_free = 0;
      for (int round = 0; round < rounds; ++round) {
        const double turn = random.Uniform(0, 2 * M_PI);
        alignas(64) RTCRay16 rays;
        alignas(64) int valid[kRays];
        for (int i = 0; i < kRays; ++i) {
          // Cosine-weighted points of the hemisphere on a sunflower spiral.
          const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / kRays),
                      angle = static_cast<float>(turn + 2.399963 * i);
          const Eigen::Vector3f direction = radius * (std::cos(angle) * u + std::sin(angle) * v) +
                                            std::sqrt(1 - radius * radius) * normal;
          rays.org_x[i] = origin.x(), rays.org_y[i] = origin.y(), rays.org_z[i] = origin.z();
          rays.dir_x[i] = direction.x(), rays.dir_y[i] = direction.y(),
          rays.dir_z[i] = direction.z();
          rays.tnear[i] = 0, rays.tfar[i] = reach, rays.time[i] = 0;
          rays.mask[i] = ~0u, rays.id[i] = 0, rays.flags[i] = 0;
          valid[i] = -1;
        }
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded16(valid, scene_.get(), &context, &rays);
        for (const float far : rays.tfar) num_free += far >= 0;
      }
      ambient[vertex] = static_cast<float>(num_free) / static_cast<float>(kRays * rounds);
    }
  });
  return ambient;
}

std::vector<Color> RayScene::VertexLamps(const Mesh& mesh, const LampField& lamps) const {
  constexpr size_t kBlock = 256;
  std::vector<Color> light(mesh.positions.size(), Gray(0));
  if (lamps.empty()) return light;
  ParallelFor((light.size() + kBlock - 1) / kBlock, [&](size_t block) {
    const FlushDenormals flush;
    const size_t end = std::min(light.size(), (block + 1) * kBlock);
    for (size_t vertex = block * kBlock; vertex < end; ++vertex) {
      const Eigen::Vector3f& normal = mesh.normals[vertex];
      const Eigen::Vector3f origin = mesh.positions[vertex] + 0.02f * normal;
      for (const std::uint32_t index : lamps.Near(origin)) {
        const Lamp& lamp = lamps.lamps()[index];
        const Color bright = LampField::Irradiance(lamp, origin, normal);
        if (bright[1] < 1e-4f) continue;
        const Eigen::Vector3f to_lamp = lamp.position - origin;
        RTCRay ray{};
        ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
        ray.dir_x = to_lamp.x(), ray.dir_y = to_lamp.y(), ray.dir_z = to_lamp.z();
        ray.tfar = 0.98f;
        ray.mask = ~0u;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene_.get(), &context, &ray);
        if (ray.tfar >= 0) light[vertex] += bright;
      }
    }
  });
  return light;
}

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

}  // namespace parkade::simulator
