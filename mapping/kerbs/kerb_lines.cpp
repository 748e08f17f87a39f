#include "mapping/kerbs/kerb_lines.h"

#include <algorithm>
#include <cmath>

#include "core/math/statistics.h"
#include "core/parallel.h"
#include "mapping/kerbs/kerb_ends.h"

namespace parkade {
namespace {

constexpr int kReachOfLine = 5;         // strips to each side that a line is fitted to ...
constexpr std::size_t kMinOnLine = 5;   // ... and so many must be kerbs
constexpr double kStraight = 0.08;      // [m] rms off their line
constexpr double kReach = 15;           // [m] along a line
constexpr double kMaxOff = 0.15;        // [m] off it nearby ...
constexpr double kMaxTurn = 0.015;      // ... and more by so much a meter along it
constexpr double kMinParallel = 0.94;   // cosine of the angle between a strip and the line
constexpr std::size_t kMinSupport = 6;  // strips of kerbs whose lines meet one
constexpr double kMaxRise = 0.05;       // [m per m] of the ground between them
constexpr double kLeastSigma = 0.02;    // [m] of a height that was not seen

/// The line through a kerb.
struct KerbLine {
  Eigen::Vector3d foot;   ///< [m] on the ground at the kerb
  Eigen::Vector2d along;  ///< unit; the drivable ground lies on the left
  KerbStep step;
};

std::optional<KerbLine> LineAt(std::size_t strip, std::span<const OutlineStrip> strips,
                               const StripsAlong& along,
                               std::span<const std::optional<KerbStep>> steps,
                               const std::vector<bool>& is_kerb) {
  std::vector<KerbPlace> places;
  for (const std::size_t i : Around(strips[strip], along, kReachOfLine))
    if (is_kerb[i]) places.push_back({strips[i].foot, strips[i].along});
  if (places.size() < kMinOnLine) return {};
  const KerbAxis axis = FitAxis(places, strips[strip].along);
  double square = 0;
  for (const KerbPlace& place : places)
    square += std::pow(Beside((place.foot - axis.middle).head<2>(), axis.direction), 2);
  if (square > kStraight * kStraight * static_cast<double>(places.size())) return {};
  const Eigen::Vector2d outward(axis.direction.y(), -axis.direction.x());
  Eigen::Vector3d foot = strips[strip].foot;
  foot.head<2>() -= Beside((foot - axis.middle).head<2>(), axis.direction) * outward;
  return KerbLine{foot, axis.direction, *steps[strip]};
}

bool IsOn(const KerbLine& line, const OutlineStrip& strip) {
  const Eigen::Vector3d between = strip.foot - line.foot;
  const double distance = between.head<2>().dot(line.along),
               off = between.x() * line.along.y() - between.y() * line.along.x();
  return std::abs(distance) <= kReach && std::abs(off) <= kMaxOff + kMaxTurn * std::abs(distance) &&
         std::abs(between.z()) <= kMaxOff + kMaxRise * std::abs(distance) &&
         strip.along.dot(line.along) >= kMinParallel;
}

/// The step of the lines that a strip lies on, if they are enough. \param lines by x
std::optional<KerbStep> StepAlong(const OutlineStrip& strip, std::span<const KerbLine> lines) {
  const auto begin = std::partition_point(lines.begin(), lines.end(), [&](const KerbLine& line) {
    return line.foot.x() < strip.foot.x() - kReach;
  });
  std::vector<double> heights, sigmas;
  for (auto line = begin; line != lines.end() && line->foot.x() <= strip.foot.x() + kReach; ++line)
    if (IsOn(*line, strip)) {
      heights.push_back(line->step.height);
      sigmas.push_back(line->step.sigma);
    }
  if (heights.size() < kMinSupport) return {};
  const double height = Median(heights);
  return KerbStep{height, std::max({Median(sigmas), MadSigma(heights, height), kLeastSigma})};
}

}  // namespace

void ContinueLines(std::span<const OutlineStrip> strips, std::span<const KerbLook> looks,
                   const StripsAlong& along, double min_height,
                   std::vector<std::optional<KerbStep>>& steps, std::vector<bool>& is_kerb) {
  const auto line_at = ParallelMap(strips.size(), [&](std::size_t i) {
    return is_kerb[i] ? LineAt(i, strips, along, steps, is_kerb) : std::nullopt;
  });
  std::vector<KerbLine> lines;
  for (const std::optional<KerbLine>& line : line_at)
    if (line) lines.push_back(*line);
  std::sort(lines.begin(), lines.end(), [](const KerbLine& a, const KerbLine& b) {
    return std::lexicographical_compare(a.foot.begin(), a.foot.end(), b.foot.begin(), b.foot.end());
  });
  const auto may_be_kerb = [&](std::size_t i) {
    return !is_kerb[i] && looks[i] != KerbLook::kNone &&
           (!steps[i] ||
            (steps[i]->height >= min_height && steps[i]->height <= KerbStep::kMaxKerb));
  };
  const auto found = ParallelMap(strips.size(), [&](std::size_t i) {
    return may_be_kerb(i) ? StepAlong(strips[i], lines) : std::nullopt;
  });
  for (std::size_t i = 0; i < strips.size(); ++i)
    if (found[i]) steps[i] = found[i], is_kerb[i] = true;
}

}  // namespace parkade
