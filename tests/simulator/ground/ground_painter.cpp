#include "tests/simulator/ground/ground_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tests/simulator/common/noise.h"
#include "tests/simulator/common/rectangle.h"

namespace parkade::simulator {

using Eigen::Vector2d;
using Eigen::Vector2f;

namespace {

/// Share of a texel inside a shape, from the signed distance [m] to its border.
float Cover(float signed_distance, float texel) {
  return std::clamp(0.5f - signed_distance / texel, 0.0f, 1.0f);
}

float DistanceToSegment(const Vector2f& point, const Vector2f& a, const Vector2f& b) {
  const Vector2f side = b - a;
  const float along =
      std::clamp((point - a).dot(side) / std::max(1e-9f, side.squaredNorm()), 0.0f, 1.0f);
  return (point - a - along * side).norm();
}

}  // namespace

GroundPainter::GroundPainter(const Vector2d& extent, GroundCanvas& canvas, std::uint64_t seed)
    : extent_(extent),
      canvas_(canvas),
      random_(seed, 0x9a17),
      seed_(static_cast<std::uint32_t>(Mix64(seed))),
      texel_(static_cast<float>(canvas.texel_size())) {}

void GroundPainter::Asphalt(const RoadLook& look, const std::function<bool(float, float)>& covers) {
  const MipTexture* pattern =
      look.pattern == TextureKind::kNone ? nullptr : &DetailTexture(look.pattern);
  canvas_.Fill([&](float x, float y) {
    if (covers && !covers(x, y)) return Gray(0.125f);
    const float broad = FractalNoise(0.13f * x, 0.13f * y, 3, seed_),
                middle = FractalNoise(1.1f * x, 1.3f * y, 3, seed_ + 10);
    const float speckle =
        CellValue(static_cast<int>(x / texel_), static_cast<int>(y / texel_), seed_ + 20);
    const float grain = SmoothNoise(17 * x, 17 * y, seed_ + 21);
    const float value = 1 + 0.16f * broad + 0.10f * middle + 0.10f * grain + 0.16f * speckle;
    const float laid = pattern ? pattern->Sample(x / look.pattern_size, y / look.pattern_size,
                                                 texel_ / look.pattern_size)
                               : 0;
    return Color(look.albedo * value * std::max(0.2f, 1 + look.pattern_contrast * laid));
  });
}

void GroundPainter::Concrete() {
  constexpr float kSlab = 6;
  canvas_.Fill([&](float x, float y) {
    const float broad = FractalNoise(0.2f * x, 0.2f * y, 3, seed_),
                middle = FractalNoise(1.7f * x, 1.7f * y, 4, seed_ + 10);
    const float speckle =
        CellValue(static_cast<int>(x / texel_), static_cast<int>(y / texel_), seed_ + 20);
    const float slab = CellValue(FastFloorToInt(x / kSlab), FastFloorToInt(y / kSlab), seed_ + 30);
    const float joint = std::min(std::abs(x / kSlab - std::round(x / kSlab)),
                                 std::abs(y / kSlab - std::round(y / kSlab))) *
                        kSlab;
    const float grain = SmoothNoise(17 * x, 17 * y, seed_ + 21);
    const float value = 0.24f * (1 + 0.18f * broad + 0.20f * middle + 0.10f * grain + 0.08f * slab +
                                 0.10f * speckle);
    return Color(Rgb(value, 0.985f * value, 0.95f * value) *
                 (1 - 0.7f * Cover(joint - 0.008f, texel_)));
  });
}

void GroundPainter::Ribbed(const std::function<float(float, float)>& along) {
  constexpr float kSpacing = 0.16f, kHalf = 0.022f;  // [m]
  canvas_.Fill([&](float x, float y) {
    // No groove is quite straight, as deep as the next one, or as dirty all along.
    const float across =
        along(x, y) / kSpacing + 0.3f * FractalNoise(0.8f * x, 0.8f * y, 2, seed_ + 30);
    const float groove = (std::abs(across - std::round(across))) * kSpacing - kHalf;
    const float depth = 0.38f + 0.12f * CellValue(FastFloorToInt(across + 0.5f), 0, seed_ + 31) +
                        0.25f * FractalNoise(2.3f * x, 2.3f * y, 3, seed_ + 32);
    const float middle = FractalNoise(1.1f * x, 1.1f * y, 4, seed_ + 10),
                grain = FractalNoise(9 * x, 9 * y, 3, seed_ + 21);
    const float speckle =
        CellValue(static_cast<int>(x / texel_), static_cast<int>(y / texel_), seed_ + 20);
    const float value = 0.19f * (1 + 0.30f * middle + 0.30f * grain + 0.14f * speckle);
    return Color(Gray(value) * (1 - std::clamp(depth, 0.05f, 0.7f) * Cover(groove, texel_)));
  });
}

void GroundPainter::Patches(int count, const Chooser& place) {
  for (int i = 0; i < count; ++i) {
    const Vector2d half(random_.Uniform(0.3, 2.4), random_.Uniform(0.25, 0.9));
    const Rectangle patch{(place ? place() : Anywhere()), half,
                          random_.Chance(0.8) ? 0 : random_.Uniform(0, M_PI)};
    const float tone = static_cast<float>(random_.Uniform(0.06, 0.16));
    const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
    canvas_.Paint(patch.center, half.norm() + 0.1, [&](float x, float y) -> GroundCanvas::Touch {
      const float wobble = 0.02f * SmoothNoise(5 * x, 5 * y, seed);
      const float distance = static_cast<float>(patch.SignedDistance(Vector2d(x, y))) + wobble;
      const float speckle =
          CellValue(static_cast<int>(x / texel_), static_cast<int>(y / texel_), seed);
      if (std::abs(distance) < 0.03f)
        return {Gray(0.035f), 0.9f * Cover(std::abs(distance) - 0.02f, texel_)};
      return {Gray(tone * (1 + 0.2f * speckle)), 0.85f * Cover(distance, texel_)};
    });
  }
}

void GroundPainter::Cracks(int count, const Chooser& place) {
  for (int i = 0; i < count; ++i)
    Crack((place ? place() : Anywhere()), random_.Uniform(0, 2 * M_PI), random_.Uniform(1, 9),
          random_.Uniform(0.003, 0.012), 2);
}

void GroundPainter::Stains(int count, const Chooser& oil_place, const Chooser& place) {
  for (int i = 0; i < count; ++i) {
    const bool is_oil = random_.Chance(0.6);
    const Vector2d center = is_oil ? oil_place() : place ? place() : Anywhere();
    const double radius = is_oil ? random_.Uniform(0.04, 0.35) : random_.Uniform(0.2, 1.3);
    const float cover = static_cast<float>(random_.Uniform(0.25, 0.8)) * (is_oil ? 1.0f : 0.5f);
    const Color color = random_.Chance(0.15)
                            ? Rgb(0.16f, 0.12f, 0.08f)
                            : Gray(is_oil ? 0.03f : static_cast<float>(random_.Uniform(0.05, 0.2)));
    const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
    canvas_.Paint(center, 1.5 * radius, [&](float x, float y) -> GroundCanvas::Touch {
      const float r = (Vector2f(x, y) - center.cast<float>()).norm() / static_cast<float>(radius);
      const float edge = r + 0.7f * FractalNoise(3 * x / static_cast<float>(radius),
                                                 3 * y / static_cast<float>(radius), 3, seed);
      return {color, cover * (1 - SmoothStep(0.45f, 1.0f, edge))};
    });
  }
}

void GroundPainter::Litter(int count, const Chooser& place) {
  while (count > 0) {
    const Vector2d drift = (place ? place() : Anywhere());
    const double spread = random_.Uniform(0.3, 4);
    for (int in_drift = 2 + random_.Index(60); in_drift-- > 0 && count-- > 0;) {
      const Vector2d center = drift + spread * Vector2d(random_.Normal(), random_.Normal());
      const double radius = random_.Uniform(0.008, 0.03), stretch = random_.Uniform(1, 2.2),
                   angle = random_.Uniform(0, M_PI);
      const Color color =
          random_.Chance(0.3)
              ? Color(Rgb(0.30f, 0.20f, 0.06f) * static_cast<float>(random_.Uniform(0.4, 1.4)))
          : random_.Chance(0.5) ? Gray(static_cast<float>(random_.Uniform(0.25, 0.6)))
                                : Gray(static_cast<float>(random_.Uniform(0.02, 0.07)));
      const Vector2f axis(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
      canvas_.Paint(
          center, radius * stretch + texel_, [&](float x, float y) -> GroundCanvas::Touch {
            const Vector2f offset = Vector2f(x, y) - center.cast<float>();
            const float along = offset.dot(axis) / static_cast<float>(stretch),
                        across = offset.x() * axis.y() - offset.y() * axis.x();
            return {color,
                    0.9f * Cover(std::hypot(along, across) - static_cast<float>(radius), texel_)};
          });
    }
  }
}

void GroundPainter::Manhole(const Vector2d& center) {
  canvas_.Paint(center, 0.5, [&](float x, float y) -> GroundCanvas::Touch {
    const Vector2f offset = Vector2f(x, y) - center.cast<float>();
    const float r = offset.norm();
    if (r > 0.36f) return {Gray(0.2f), Cover(r - 0.43f, texel_)};
    const bool is_ridge = (static_cast<int>(std::floor(offset.x() / 0.045f)) +
                           static_cast<int>(std::floor(offset.y() / 0.045f))) %
                              2 ==
                          0;
    return {Gray(r > 0.32f ? 0.03f : is_ridge ? 0.16f : 0.06f), 1};
  });
}

void GroundPainter::Drain(const Vector2d& center, double yaw) {
  const Rectangle frame{center, {0.25, 0.15}, yaw};
  const float c = static_cast<float>(std::cos(yaw)), s = static_cast<float>(std::sin(yaw));
  canvas_.Paint(center, 0.32, [&](float x, float y) -> GroundCanvas::Touch {
    const float distance = static_cast<float>(frame.SignedDistance(Vector2d(x, y)));
    if (distance > -0.03f) return {Gray(0.11f), Cover(distance, texel_), false, true};
    const Vector2f offset = Vector2f(x, y) - center.cast<float>();
    const float along = (c * offset.x() + s * offset.y()) / 0.05f;
    return {Gray(std::abs(along - std::round(along)) < 0.25f ? 0.015f : 0.09f), 1, false, true};
  });
}

void GroundPainter::Gutter(const Vector2d& from, const Vector2d& to) {
  const Vector2f a = from.cast<float>(), b = to.cast<float>(), along = (b - a).normalized();
  canvas_.Paint(
      (from + to) / 2, (to - from).norm() / 2 + 0.2, [&](float x, float y) -> GroundCanvas::Touch {
        const float aside = DistanceToSegment({x, y}, a, b);
        if (aside > 0.08f) return {Gray(0.26f), 0.8f * Cover(aside - 0.14f, texel_), false, true};
        const float bar = (Vector2f(x, y) - a).dot(along) / 0.04f;
        return {Gray(std::abs(bar - std::round(bar)) < 0.3f ? 0.02f : 0.12f), 1, false, true};
      });
}

void GroundPainter::Leaf(const Vector2d& center) {
  const double half_length = random_.Uniform(0.02, 0.06), angle = random_.Uniform(0, 2 * M_PI);
  const float half_width = static_cast<float>(half_length * random_.Uniform(0.4, 0.8));
  // Yellow through orange to brown, some wet and dark.
  const Color yellow = Rgb(0.5f, 0.36f, 0.05f), brown = Rgb(0.13f, 0.06f, 0.025f);
  const float age = static_cast<float>(random_.Uniform());
  const Color color =
      (yellow + age * (brown - yellow)) * static_cast<float>(random_.Uniform(0.5, 1.2));
  const Vector2f axis(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
  canvas_.Paint(center, half_length + texel_, [&](float x, float y) -> GroundCanvas::Touch {
    const Vector2f offset = Vector2f(x, y) - center.cast<float>();
    const float along = offset.dot(axis) / static_cast<float>(half_length),
                across = (offset.x() * axis.y() - offset.y() * axis.x()) / half_width;
    return {color, 0.95f * Cover((std::hypot(along, across) - 1) * half_width, texel_), false,
            true};
  });
}

void GroundPainter::Snow(const std::function<double(const Vector2d&)>& depth) {
  const Vector2d middle = (canvas_.min() + canvas_.max()) / 2;
  const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
  canvas_.Paint(
      middle, (canvas_.max() - middle).maxCoeff(), [&](float x, float y) -> GroundCanvas::Touch {
        const float deep = static_cast<float>(depth(Vector2d(x, y)));
        constexpr float kRagged = 0.9f;  // of the depth
        if (deep < -kRagged) return {};
        const float broad = FractalNoise(0.7f * x, 0.7f * y, 4, seed),
                    fine = FractalNoise(7 * x, 7 * y, 3, seed + 20);
        const float cover = SmoothStep(0.35f, 0.65f, deep + kRagged * broad + 0.25f * fine);
        if (cover <= 0) return {};
        const float trodden = 0.62f + 0.12f * broad + 0.08f * fine;
        return {Rgb(0.97f * trodden, 0.99f * trodden, 1.03f * trodden), 0.96f * cover, false, true};
      });
}

void GroundPainter::Line(const Vector2d& from, const Vector2d& to, double width, float wear,
                         const Color& color) {
  const Vector2f a = from.cast<float>(), b = to.cast<float>();
  canvas_.Paint((from + to) / 2, (to - from).norm() / 2 + width,
                [&](float x, float y) -> GroundCanvas::Touch {
                  return Worn(x, y, DistanceToSegment({x, y}, a, b) - static_cast<float>(width / 2),
                              wear, color);
                });
}

void GroundPainter::TireTrack(const Vector2d& from, const Vector2d& to, double width, float cover) {
  const Vector2f a = from.cast<float>(), b = to.cast<float>();
  const float half = static_cast<float>(width / 2);
  const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
  canvas_.Paint((from + to) / 2, (to - from).norm() / 2 + width,
                [&](float x, float y) -> GroundCanvas::Touch {
                  const float aside = DistanceToSegment({x, y}, a, b) / half;
                  if (aside > 1) return {};
                  const float streaks = 0.6f + 0.4f * FractalNoise(0.7f * x, 0.7f * y, 3, seed);
                  return {Gray(0.035f), cover * streaks * (1 - SmoothStep(0.4f, 1.0f, aside))};
                });
}

void GroundPainter::TireCircle(const Vector2d& center, double radius, double width, float cover) {
  const Vector2f middle = center.cast<float>();
  const float half = static_cast<float>(width / 2);
  const std::uint32_t seed = static_cast<std::uint32_t>(random_.Bits());
  canvas_.Paint(center, radius + width, [&](float x, float y) -> GroundCanvas::Touch {
    const float aside =
        std::abs((Vector2f(x, y) - middle).norm() - static_cast<float>(radius)) / half;
    if (aside > 1) return {};
    const float streaks = 0.6f + 0.4f * FractalNoise(0.7f * x, 0.7f * y, 3, seed);
    return {Gray(0.035f), cover * streaks * (1 - SmoothStep(0.4f, 1.0f, aside))};
  });
}

void GroundPainter::Circle(const Vector2d& center, double radius, double width, float wear,
                           const Color& color) {
  const Vector2f middle = center.cast<float>();
  canvas_.Paint(center, radius + width, [&](float x, float y) -> GroundCanvas::Touch {
    const float aside = std::abs((Vector2f(x, y) - middle).norm() - static_cast<float>(radius));
    return Worn(x, y, aside - static_cast<float>(width / 2), wear, color);
  });
}

void GroundPainter::Number(int value, const Vector2d& center, double yaw, double height) {
  // Seven strokes: top, upper right, lower right, bottom, lower left, upper left, middle.
  static constexpr std::array<int, 10> kStrokes = {0x3f, 0x06, 0x5b, 0x4f, 0x66,
                                                   0x6d, 0x7d, 0x07, 0x7f, 0x6f};
  static const std::array<std::array<Vector2d, 2>, 7> kEnds = {{{{{0, 2}, {1, 2}}},
                                                                {{{1, 2}, {1, 1}}},
                                                                {{{1, 1}, {1, 0}}},
                                                                {{{0, 0}, {1, 0}}},
                                                                {{{0, 0}, {0, 1}}},
                                                                {{{0, 1}, {0, 2}}},
                                                                {{{0, 1}, {1, 1}}}}};
  const std::string digits = std::to_string(value);
  const double step = height / 2;
  const Vector2d right(std::cos(yaw), std::sin(yaw)), up(-right.y(), right.x());
  Vector2d corner =
      center - up * step - right * (step * (1.5 * static_cast<double>(digits.size()) - 0.5) / 2);
  for (const char digit : digits) {
    for (size_t stroke = 0; stroke < 7; ++stroke) {
      if (!(kStrokes[static_cast<size_t>(digit - '0')] >> stroke & 1)) continue;
      const auto at = [&](const Vector2d& place) -> Vector2d {
        return corner + step * (place.x() * right + place.y() * up);
      };
      Line(at(kEnds[stroke][0]), at(kEnds[stroke][1]), 0.14 * height, 0.25f);
    }
    corner += 1.5 * step * right;
  }
}

GroundCanvas::Touch GroundPainter::Worn(float x, float y, float signed_distance, float wear,
                                        const Color& color) const {
  const float cover = Cover(signed_distance, texel_);
  if (cover <= 0) return {};
  const float flakes = FractalNoise(2.1f * x, 2.1f * y, 4, seed_ + 40) +
                       0.6f * FractalNoise(40 * x, 40 * y, 2, seed_ + 50);
  const float kept = 1 - SmoothStep(0.75f - wear, 1.1f - wear, flakes + 0.45f);
  return {color, cover * (0.12f + 0.83f * kept), true};
}

void GroundPainter::Crack(Vector2d at, double heading, double length, double width, int forks) {
  for (double done = 0; done < length;) {
    const double step = random_.Uniform(0.05, 0.2);
    heading += random_.Uniform(-0.55, 0.55);
    const Vector2d next = at + step * Vector2d(std::cos(heading), std::sin(heading));
    const Vector2f a = at.cast<float>(), b = next.cast<float>();
    const double half = width * random_.Uniform(0.3, 1);
    canvas_.Paint((at + next) / 2, step / 2 + width + 2 * texel_,
                  [&](float x, float y) -> GroundCanvas::Touch {
                    return {Gray(0.028f), 0.85f * Cover(DistanceToSegment({x, y}, a, b) -
                                                            static_cast<float>(half),
                                                        1.5f * texel_)};
                  });
    if (forks > 0 && random_.Chance(0.03))
      Crack(next, heading + random_.Uniform(-1.3, 1.3), 0.5 * (length - done), 0.7 * width,
            forks - 1);
    at = next;
    done += step;
  }
}

void GroundPainter::Arrow(const Vector2d& center, double yaw) {
  const float c = static_cast<float>(std::cos(yaw)), s = static_cast<float>(std::sin(yaw));
  canvas_.Paint(center, 1.6, [&](float x, float y) -> GroundCanvas::Touch {
    const Vector2f offset = Vector2f(x, y) - center.cast<float>();
    const float along = c * offset.x() + s * offset.y(),
                across = std::abs(c * offset.y() - s * offset.x());
    const float shaft = std::max(std::max(-1.5f - along, along - 0.5f), across - 0.075f);
    const float head = std::max(0.5f - along, (across - 0.36f * (1.5f - along)) * 0.94f);
    return Worn(x, y, std::min(shaft, head), 0.3f, kWhitePaint);
  });
}

}  // namespace parkade::simulator
