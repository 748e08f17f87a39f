#include "tests/simulator/render/lens_flare.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/simulator/common/noise.h"

namespace parkade::simulator {
namespace {

/// A reflection between two surfaces of a lens.
struct Ghost {
  float along;     ///< from the image's middle; 1: the sun, -1: opposite
  float radius;    ///< of the image's width
  float strength;  ///< [1/sr] of the sun's irradiance
  float red, green, blue;
};

constexpr std::array<Ghost, 5> kGhosts = {{{-0.35f, 0.035f, 0.02f, 0.6f, 1, 0.7f},
                                           {-0.7f, 0.09f, 0.006f, 1, 0.8f, 0.5f},
                                           {0.45f, 0.02f, 0.03f, 0.5f, 0.7f, 1},
                                           {-1.1f, 0.05f, 0.008f, 1, 0.5f, 0.8f},
                                           {0.75f, 0.06f, 0.007f, 0.7f, 1, 1}}};

/// [1/sr] share of the sun's irradiance that is scattered by an angle [rad] whose cosine is given.
float Veil(float cosine) {
  constexpr float kScatter = 0.0008f, kCore = 0.03f, kEverywhere = 0.0012f;
  const float squared_angle = 2 * (1 - cosine);  // of a small angle
  return kScatter / (squared_angle + kCore * kCore) + kEverywhere;
}

}  // namespace

void AddFlare(const Eigen::Vector3f& to_sun, const Color& sun, const CameraModel& model,
              const SampleTable& table, cv::Mat& radiance) {
  const auto add = [&](int row, int column, const Color& light) {
    cv::Vec3f& pixel = radiance.at<cv::Vec3f>(row, column);
    if (pixel != cv::Vec3f::zeros()) pixel += cv::Vec3f(light[0], light[1], light[2]);
  };
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      const SamplePacket& packet = table.PacketOf(column, row);
      const int lane = column % kPixelsPerPacket * kSamplesPerPixel;
      add(row, column,
          sun * Veil(to_sun.dot(Eigen::Vector3f(packet.x[lane], packet.y[lane], packet.z[lane]))));
    }
  }
  const auto image = model.Project(to_sun.cast<double>());
  if (!image) return;
  const Eigen::Vector2f middle(static_cast<float>(table.width) / 2,
                               static_cast<float>(table.height) / 2);
  const Eigen::Vector2f toward_sun = image->cast<float>() - middle;
  for (const Ghost& ghost : kGhosts) {
    const Eigen::Vector2f at = middle + ghost.along * toward_sun;
    const float radius = ghost.radius * static_cast<float>(table.width);
    const int top = std::max(0, static_cast<int>(at.y() - radius)),
              bottom = std::min(table.height - 1, static_cast<int>(at.y() + radius)),
              left = std::max(0, static_cast<int>(at.x() - radius)),
              right = std::min(table.width - 1, static_cast<int>(at.x() + radius));
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        const float away =
            (Eigen::Vector2f(static_cast<float>(column), static_cast<float>(row)) - at).norm() /
            radius;
        const float strength = ghost.strength * (1 - SmoothStep(0.85f, 1, away));
        add(row, column, sun * Rgb(ghost.red, ghost.green, ghost.blue) * strength);
      }
    }
  }
}

}  // namespace parkade::simulator
