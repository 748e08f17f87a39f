#include "tests/simulator/render/shading.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/common/noise.h"

namespace parkade::simulator {
namespace {

/// Two copies of a texture in unlike scales and directions: together they do not
/// repeat over any distance that matters.
float Detail(const MipTexture& texture, float u, float v, float footprint, float size) {
  const float first = 1 / size, second = 1.618f / size;
  return 0.8f * texture.Sample(u * first, v * first, footprint * first) +
         0.6f * texture.Sample((0.8f * u + 0.6f * v) * second, (0.8f * v - 0.6f * u) * second,
                               footprint * second);
}

/// 0 for a wet film, 1 in a puddle.
float Puddle(const Eigen::Vector3f& position) {
  return SmoothStep(0.13f, 0.2f, FractalNoise(0.21f * position.x(), 0.21f * position.y(), 3, 77));
}

Color GroundAlbedo(const Scene& scene, const SurfacePoint& point, float footprint) {
  const float x = point.position.x(), y = point.position.y();
  const Color dry = scene.ground_colors[point.material].Sample(x, y, footprint);
  const float wetness = scene.finish.empty() ? 0 : scene.finish[point.material].wetness;
  const float wet = wetness > 0 ? wetness * (0.45f + 0.25f * Puddle(point.position)) : 0;
  const Color painted = dry * (1 - wet);
  if (footprint > 0.06f) return painted;  // stones of a centimeter average out
  static const MipTexture& aggregate = DetailTexture(TextureKind::kAggregate);
  return painted * std::max(0.2f, 1 + 0.20f * Detail(aggregate, x, y, footprint, 0.9f));
}

Color ObjectAlbedo(const Material& material, const SurfacePoint& point, float footprint) {
  if (material.texture == TextureKind::kNone) return material.albedo;
  const Eigen::Vector3f& normal = point.flat_normal;
  const float level = std::hypot(normal.x(), normal.y());
  float u = point.position.x(), v = point.position.y();
  if (level > 0.7f) {
    u = (point.position.y() * normal.x() - point.position.x() * normal.y()) / level;
    v = point.position.z();
  }
  const MipTexture& texture = DetailTexture(material.texture);
  // Bricks have to stay in their courses: one copy, and a slow change of tone.
  const float value = material.texture == TextureKind::kBrick
                          ? texture.Sample(u / material.texture_size, v / material.texture_size,
                                           footprint / material.texture_size)
                          : Detail(texture, u, v, footprint, material.texture_size);
  return material.albedo * std::max(0.1f, 1 + material.texture_contrast * value);
}

Color Reflection(const Scene& scene, const SurfacePoint& point, float head_on) {
  const float cosine = std::clamp(-point.ray.dot(point.normal), 0.0f, 1.0f);
  const float grazing = 1 - cosine, squared = grazing * grazing;
  const float share = head_on + (1 - head_on) * 0.6f * squared * squared * grazing;
  const Eigen::Vector3f mirrored = point.ray - 2 * point.ray.dot(point.normal) * point.normal;
  // Around the surface there is sky, or what the lamps light.
  const Color sky = mirrored.z() > 0
                        ? Color(scene.sky.Radiance(mirrored).min(6.0f))
                        : Color(scene.sky.AmbientIrradiance(-Eigen::Vector3f::UnitZ()) * 0.32f);
  return (sky * (0.4f + 0.6f * point.ambient) * point.openness + point.light * 0.12f) * share;
}

}  // namespace

float GroundMirror(const Scene& scene, const SurfacePoint& point) {
  const float cosine = std::clamp(-point.ray.dot(point.normal), 0.0f, 1.0f), grazing = 1 - cosine;
  const float squared = grazing * grazing, fresnel = 0.025f + 0.975f * squared * squared * grazing;
  const GroundFinish& finish = scene.finish[point.material];
  const float water =
      finish.wetness > 0 ? finish.wetness * (0.3f + 0.7f * Puddle(point.position)) : 0;
  return fresnel * std::max(finish.gloss, water);
}

Color Shade(const Scene& scene, const SurfacePoint& point) {
  constexpr float kInversePi = 0.318310f, kHazeDistance = 900;
  // A ray stands for a patch that is stretched where the surface is seen at a
  // shallow angle; half of the stretch is covered by the other rays of the pixel.
  const float across = point.distance * point.sample_angle;
  const float cosine = std::max(0.02f, std::abs(point.ray.dot(point.flat_normal)));
  const float footprint = std::max(across, 0.5f * across / cosine) + point.motion;

  const Color irradiance = scene.sky.sun_irradiance() * point.sun +
                           scene.sky.AmbientIrradiance(point.normal) * point.ambient + point.light;
  Color radiance;
  if (point.is_ground) {
    radiance = GroundAlbedo(scene, point, footprint) * irradiance * kInversePi + point.reflected;
  } else {
    const Material& material = scene.materials[point.material];
    radiance =
        ObjectAlbedo(material, point, footprint) * irradiance * kInversePi + material.emission;
    if (material.mirror > 0) radiance += Reflection(scene, point, material.mirror);
  }
  const float clear = std::exp(-point.distance / kHazeDistance);
  return radiance * clear + scene.sky.haze() * ((1 - clear) * point.openness);
}

}  // namespace parkade::simulator
