#include "tests/simulator/lot_ground.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/noise.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2f;

/// Share of a texel inside a shape, from the signed distance [m] to its border.
float Cover(float signed_distance, float texel) { return std::clamp(0.5f - signed_distance / texel, 0.0f, 1.0f); }

float DistanceToSegment(const Vector2f& point, const Vector2f& a, const Vector2f& b) {
  const Vector2f side = b - a;
  const float along = std::clamp((point - a).dot(side) / std::max(1e-9f, side.squaredNorm()), 0.0f, 1.0f);
  return (point - a - along * side).norm();
}

/// Paints on one canvas with one stream of random numbers.
class LotPainter {
 public:
  LotPainter(const LotLayout& layout, GroundCanvas& canvas, std::uint64_t seed)
      : layout_(layout),
        canvas_(canvas),
        random_(seed, 0x9a17),
        seed_(static_cast<std::uint32_t>(Mix64(seed))),
        texel_(static_cast<float>(canvas.texel_size())) {}

  void Asphalt() {
    canvas_.Fill([&](float x, float y) {
      const float broad = FractalNoise(0.13f * x, 0.13f * y, 3, seed_),
                  middle = FractalNoise(1.1f * x, 1.3f * y, 3, seed_ + 10);
      const float speckle = CellValue(static_cast<int>(x / texel_), static_cast<int>(y / texel_), seed_ + 20);
      const float grain = SmoothNoise(17 * x, 17 * y, seed_ + 21);
      const float value = 0.125f * (1 + 0.16f * broad + 0.10f * middle + 0.10f * grain + 0.16f * speckle);
      return Rgb(1.02f * value, value, 0.96f * value);
    });
  }

  /// Repairs: rectangles of younger asphalt with a sealed seam.
  void Patches(int count) {
    for (int i = 0; i < count; ++i) {
      const Vector2d half(random_.Uniform(0.3, 2.4), random_.Uniform(0.25, 0.9));
      const Rectangle patch{Anywhere(), half, random_.Chance(0.8) ? 0 : random_.Uniform(0, M_PI)};
      const float tone = static_cast<float>(random_.Uniform(0.06, 0.16));
      const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
      canvas_.Paint(patch.center, half.norm() + 0.1, [&](float x, float y) -> GroundCanvas::Touch {
        const float wobble = 0.02f * SmoothNoise(5 * x, 5 * y, seed);
        const float distance = static_cast<float>(patch.SignedDistance(Vector2d(x, y))) + wobble;
        const float speckle = CellValue(static_cast<int>(x / texel_), static_cast<int>(y / texel_), seed);
        if (std::abs(distance) < 0.03f) return {Gray(0.035f), 0.9f * Cover(std::abs(distance) - 0.02f, texel_)};
        return {Gray(tone * (1 + 0.2f * speckle)), 0.85f * Cover(distance, texel_)};
      });
    }
  }

  /// Random walks of a dark line, thick or thin, sometimes forking.
  void Cracks(int count) {
    for (int i = 0; i < count; ++i)
      Crack(Anywhere(), random_.Uniform(0, 2 * M_PI), random_.Uniform(1, 9), random_.Uniform(0.003, 0.012), 2);
  }

  /// Oil and rust under parked cars, spills and tyre dust elsewhere.
  void Stains(int count) {
    for (int i = 0; i < count; ++i) {
      const bool is_oil = random_.Chance(0.6);
      const Vector2d center =
          is_oil ? Vector2d(AnySlot().center + Vector2d(random_.Uniform(-0.6, 0.6), random_.Uniform(-1.5, 1.5)))
                 : Anywhere();
      const double radius = is_oil ? random_.Uniform(0.04, 0.35) : random_.Uniform(0.2, 1.3);
      const float cover = static_cast<float>(random_.Uniform(0.25, 0.8)) * (is_oil ? 1.0f : 0.5f);
      const Color color = random_.Chance(0.15) ? Rgb(0.16f, 0.12f, 0.08f)
                                               : Gray(is_oil ? 0.03f : static_cast<float>(random_.Uniform(0.05, 0.2)));
      const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
      canvas_.Paint(center, 1.5 * radius, [&](float x, float y) -> GroundCanvas::Touch {
        const float r = (Vector2f(x, y) - center.cast<float>()).norm() / static_cast<float>(radius);
        const float edge =
            r + 0.7f * FractalNoise(3 * x / static_cast<float>(radius), 3 * y / static_cast<float>(radius), 3, seed);
        return {color, cover * (1 - SmoothStep(0.45f, 1.0f, edge))};
      });
    }
  }

  /// Chewing gum, pebbles, leaves, cigarette ends; in drifts, not everywhere.
  void Litter(int count) {
    while (count > 0) {
      const Vector2d drift = Anywhere();
      const double spread = random_.Uniform(0.3, 4);
      for (int in_drift = 2 + random_.Index(60); in_drift-- > 0 && count-- > 0;) {
        const Vector2d center = drift + spread * Vector2d(random_.Normal(), random_.Normal());
        const double radius = random_.Uniform(0.008, 0.03), stretch = random_.Uniform(1, 2.2),
                     angle = random_.Uniform(0, M_PI);
        const Color color = random_.Chance(0.3)
                                ? Color(Rgb(0.30f, 0.20f, 0.06f) * static_cast<float>(random_.Uniform(0.4, 1.4)))
                            : random_.Chance(0.5) ? Gray(static_cast<float>(random_.Uniform(0.25, 0.6)))
                                                  : Gray(static_cast<float>(random_.Uniform(0.02, 0.07)));
        const Vector2f axis(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
        canvas_.Paint(center, radius * stretch + texel_, [&](float x, float y) -> GroundCanvas::Touch {
          const Vector2f offset = Vector2f(x, y) - center.cast<float>();
          const float along = offset.dot(axis) / static_cast<float>(stretch),
                      across = offset.x() * axis.y() - offset.y() * axis.x();
          return {color, 0.9f * Cover(std::hypot(along, across) - static_cast<float>(radius), texel_)};
        });
      }
    }
  }

  void Manholes(int count) {
    for (int i = 0; i < count; ++i) {
      const Vector2d center(random_.Uniform(2, layout_.length - 2),
                            layout_.aisle_y[random_.Index(2)] + random_.Uniform(-2, 2));
      canvas_.Paint(center, 0.5, [&](float x, float y) -> GroundCanvas::Touch {
        const Vector2f offset = Vector2f(x, y) - center.cast<float>();
        const float r = offset.norm();
        if (r > 0.36f) return {Gray(0.2f), Cover(r - 0.43f, texel_)};
        const bool is_ridge =
            (static_cast<int>(std::floor(offset.x() / 0.045f)) + static_cast<int>(std::floor(offset.y() / 0.045f))) %
                2 ==
            0;
        return {Gray(r > 0.32f ? 0.03f : is_ridge ? 0.16f : 0.06f), 1};
      });
    }
  }

  /// A worn white line of `width` [m].
  void Line(const Vector2d& from, const Vector2d& to, double width, float wear) {
    const Vector2f a = from.cast<float>(), b = to.cast<float>();
    canvas_.Paint((from + to) / 2, (to - from).norm() / 2 + width, [&](float x, float y) -> GroundCanvas::Touch {
      return Worn(x, y, DistanceToSegment({x, y}, a, b) - static_cast<float>(width / 2), wear);
    });
  }

  void Markings() {
    for (const Rectangle& slot : layout_.slots) {
      const float wear = static_cast<float>(random_.Uniform(0.15, 0.5));
      for (const double side : {-1.0, 1.0}) {
        const Vector2d into(std::cos(slot.yaw), std::sin(slot.yaw)), across(-into.y(), into.x());
        const Vector2d middle = slot.center + side * slot.half_size.y() * across;
        Line(middle - slot.half_size.x() * into, middle + slot.half_size.x() * into, 0.11, wear);
      }
    }
    for (int aisle = 0; aisle < 2; ++aisle) {
      const double direction = layout_.long_loop[0].y() == layout_.aisle_y[aisle] ? 1 : -1;
      for (double x = 14; x < layout_.length - 12; x += random_.Uniform(13, 19))
        Arrow({x, layout_.aisle_y[aisle] + random_.Uniform(-0.2, 0.2)}, direction);
    }
    for (const double x : {7.6, layout_.length - 7.6})
      for (const double y : layout_.aisle_y)
        for (double offset = -2.6; offset < 2.7; offset += 0.95)
          Line({x, y + offset}, {x, y + offset + 0.5}, 0.3, 0.35f);
  }

 private:
  Vector2d Anywhere() { return {random_.Uniform(0, layout_.length), random_.Uniform(0, layout_.width)}; }
  const Rectangle& AnySlot() {
    return layout_.slots[static_cast<size_t>(random_.Index(static_cast<int>(layout_.slots.size())))];
  }

  GroundCanvas::Touch Worn(float x, float y, float signed_distance, float wear) const {
    const float cover = Cover(signed_distance, texel_);
    if (cover <= 0) return {};
    const float flakes =
        FractalNoise(2.1f * x, 2.1f * y, 4, seed_ + 40) + 0.6f * FractalNoise(40 * x, 40 * y, 2, seed_ + 50);
    const float kept = 1 - SmoothStep(0.75f - wear, 1.1f - wear, flakes + 0.45f);
    return {Rgb(0.58f, 0.57f, 0.53f), cover * (0.12f + 0.83f * kept)};
  }

  void Crack(Vector2d at, double heading, double length, double width, int forks) {
    for (double done = 0; done < length;) {
      const double step = random_.Uniform(0.05, 0.2);
      heading += random_.Uniform(-0.55, 0.55);
      const Vector2d next = at + step * Vector2d(std::cos(heading), std::sin(heading));
      const Vector2f a = at.cast<float>(), b = next.cast<float>();
      const double half = width * random_.Uniform(0.3, 1);
      canvas_.Paint((at + next) / 2, step / 2 + width + 2 * texel_, [&](float x, float y) -> GroundCanvas::Touch {
        return {Gray(0.028f), 0.85f * Cover(DistanceToSegment({x, y}, a, b) - static_cast<float>(half), 1.5f * texel_)};
      });
      if (forks > 0 && random_.Chance(0.03))
        Crack(next, heading + random_.Uniform(-1.3, 1.3), 0.5 * (length - done), 0.7 * width, forks - 1);
      at = next;
      done += step;
    }
  }

  /// A direction arrow 3 m long pointing along +x or -x.
  void Arrow(const Vector2d& center, double direction) {
    canvas_.Paint(center, 1.6, [&](float x, float y) -> GroundCanvas::Touch {
      const float along = static_cast<float>((x - center.x()) * direction),
                  across = std::abs(y - static_cast<float>(center.y()));
      const float shaft = std::max(std::max(-1.5f - along, along - 0.5f), across - 0.075f);
      const float head = std::max(0.5f - along, (across - 0.36f * (1.5f - along)) * 0.94f);
      return Worn(x, y, std::min(shaft, head), 0.3f);
    });
  }

  const LotLayout& layout_;
  GroundCanvas& canvas_;
  Random random_;
  std::uint32_t seed_;
  float texel_;
};

}  // namespace

GroundCanvas PaintLot(const LotLayout& layout, double texel_size, std::uint64_t seed) {
  GroundCanvas canvas(Vector2d::Zero(), Vector2d(layout.length, layout.width), texel_size);
  const double area = layout.length * layout.width;
  const auto per_area = [&](double square_meters) { return static_cast<int>(area / square_meters); };
  LotPainter painter(layout, canvas, seed);
  painter.Asphalt();
  painter.Patches(per_area(90));
  painter.Cracks(per_area(45));
  painter.Stains(per_area(14));
  painter.Markings();
  painter.Manholes(per_area(350));
  painter.Litter(per_area(0.5));
  canvas.Finish();
  return canvas;
}

Mesh MakeLotGround(const LotLayout& layout, const Ground& ground) {
  const int columns = static_cast<int>(std::lround(layout.length * 4)) + 1,
            rows = static_cast<int>(std::lround(layout.width * 4)) + 1;
  Mesh mesh;
  mesh.AddSheet(
      columns, rows,
      [&](int i, int j) -> Eigen::Vector3d {
        const double x = layout.length * i / (columns - 1), y = layout.width * j / (rows - 1);
        return {x, y, ground.Height({x, y}, 0)};
      },
      [](int, int) { return MaterialId{0}; });
  return mesh;
}

}  // namespace parkade::simulator
