#include "tests/support/synthetic_motion.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace parkade {
namespace {

struct Key {
  double time, value;
};

constexpr double kCycle = 50;  // [s]
constexpr std::array kSpeeds{Key{0, 0},     Key{2, 0},  Key{6, 5},  Key{14, 5}, Key{17, 2.5},
                             Key{22, 4},    Key{30, 4}, Key{33, 0}, Key{37, 0}, Key{39, -1.2},
                             Key{42, -1.2}, Key{44, 0}, Key{45, 0}, Key{48, 2}, Key{50, 0}};
constexpr std::array kCurvatures{Key{0, 0},     Key{5, 0},     Key{7, 0.02},  Key{10, -0.03},
                                 Key{13, 0},    Key{15, 0.15}, Key{19, 0.15}, Key{21, 0},
                                 Key{24, -0.1}, Key{27, -0.1}, Key{30, 0},    Key{38, 0.1},
                                 Key{43, 0.1},  Key{44.5, 0},  Key{50, 0}};
constexpr std::array kSlopes{Key{0, 0},     Key{21, 0}, Key{23, 0.12},
                             Key{28, 0.12}, Key{30, 0}, Key{50, 0}};  // [rad] up

/// Value and derivative of quintic blends between keys, periodic.
template <size_t N>
std::pair<double, double> Blend(const std::array<Key, N>& keys, double time) {
  if (time < 0) return {keys[0].value, 0};
  const double at = std::fmod(time, kCycle);
  size_t i = 1;
  while (i + 1 < N && keys[i].time < at) ++i;
  const double length = keys[i].time - keys[i - 1].time, rise = keys[i].value - keys[i - 1].value;
  const double s = (at - keys[i - 1].time) / length;
  return {keys[i - 1].value + rise * s * s * s * (10 + s * (-15 + 6 * s)),
          rise * 30 * s * s * (1 - s) * (1 - s) / length};
}

struct PlanarPoint {
  double yaw = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

double YawRate(double t) { return Blend(kSpeeds, t).first * Blend(kCurvatures, t).first; }

Eigen::Quaterniond Attitude(double yaw, double slope) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(-slope, Eigen::Vector3d::UnitY());
}

Eigen::Vector3d Velocity(double t, double yaw) {
  return Blend(kSpeeds, t).first *
         (Attitude(yaw, Blend(kSlopes, t).first) * Eigen::Vector3d::UnitX());
}

/// Simpson steps for yaw and position.
PlanarPoint Integrate(const PlanarPoint& from, double begin, double step) {
  const double middle = begin + step / 2, end = begin + step;
  const auto yaw_after = [&](double length) {
    return from.yaw +
           length / 6 *
               (YawRate(begin) + 4 * YawRate(begin + length / 2) + YawRate(begin + length));
  };
  PlanarPoint to;
  to.yaw = yaw_after(step);
  to.position =
      from.position + step / 6 *
                          (Velocity(begin, from.yaw) + 4 * Velocity(middle, yaw_after(step / 2)) +
                           Velocity(end, to.yaw));
  return to;
}

Eigen::Vector3d CarRate(double t) {
  const auto [slope, slope_rate] = Blend(kSlopes, t);
  const double yaw_rate = YawRate(t);
  return {std::sin(slope) * yaw_rate, -slope_rate, std::cos(slope) * yaw_rate};
}

/// Central difference, with an error of some 1e-8 for the motions here.
Eigen::Vector3d Differentiate(const std::function<Eigen::Vector3d(double)>& function, double t) {
  constexpr double kStep = 1e-3;
  return (8 * (function(t + kStep) - function(t - kStep)) -
          (function(t + 2 * kStep) - function(t - 2 * kStep))) /
         (12 * kStep);
}

}  // namespace

MotionFunction CarMotion(double duration) {
  constexpr double kTableStep = 0.005;
  auto table = std::make_shared<std::vector<PlanarPoint>>(1);
  for (int i = 0; i * kTableStep <= duration + 1; ++i)
    table->push_back(Integrate(table->back(), i * kTableStep, kTableStep));
  return [table](double t) {
    PlanarPoint at;
    if (t > 0) {
      const auto i = std::min(static_cast<size_t>(t / kTableStep), table->size() - 1);
      const double begin = static_cast<double>(i) * kTableStep;
      at = Integrate((*table)[i], begin, t - begin);
    }
    const auto [speed, acceleration] = Blend(kSpeeds, t);
    BodyMotion motion;
    motion.world_from_body = {Attitude(at.yaw, Blend(kSlopes, t).first), at.position};
    motion.angular_velocity = CarRate(t);
    motion.angular_acceleration = Differentiate(CarRate, t);
    const Eigen::Quaterniond& rotation = motion.world_from_body.rotation;
    motion.velocity = speed * (rotation * Eigen::Vector3d::UnitX());
    motion.acceleration =
        rotation * (acceleration * Eigen::Vector3d::UnitX() +
                    speed * motion.angular_velocity.cross(Eigen::Vector3d::UnitX()));
    return motion;
  };
}

MotionFunction FlightMotion() {
  // Per axis: amplitude, angular frequency, phase of two sines.
  static constexpr double kPosition[3][6] = {{1.2, 0.9, 0.3, 0.25, 2.6, 1.0},
                                             {1.0, 1.1, 1.7, 0.2, 3.1, 0.2},
                                             {0.4, 1.4, 2.5, 0.1, 3.7, 1.5}};
  static constexpr double kAngles[3][6] = {{0.15, 1.9, 0.1, 0.05, 4.1, 0.7},
                                           {0.12, 2.3, 1.1, 0.05, 3.3, 2.0},
                                           {0.6, 0.7, 0.5, 0.1, 2.9, 0.0}};
  static const auto wave = [](const double(&c)[6], double t, int derivative) {
    double sum = 0;
    for (int k = 0; k < 6; k += 3)
      sum += c[k] * std::pow(c[k + 1], derivative) *
             std::sin(c[k + 1] * t + c[k + 2] + derivative * M_PI / 2);
    return sum;
  };
  static const auto vector = [](const double(&c)[3][6], double t, int derivative) {
    return Eigen::Vector3d(wave(c[0], t, derivative), wave(c[1], t, derivative),
                           wave(c[2], t, derivative));
  };
  static const auto rate = [](double t) -> Eigen::Vector3d {
    const Eigen::Vector3d angle = vector(kAngles, t, 0), speed = vector(kAngles, t, 1);
    const Eigen::AngleAxisd roll(angle.x(), Eigen::Vector3d::UnitX()),
        pitch(angle.y(), Eigen::Vector3d::UnitY());
    return speed.x() * Eigen::Vector3d::UnitX() +
           roll.inverse() * (speed.y() * Eigen::Vector3d::UnitY() +
                             pitch.inverse() * (speed.z() * Eigen::Vector3d::UnitZ()).eval());
  };
  return [](double t) {
    const Eigen::Vector3d angle = vector(kAngles, t, 0);
    BodyMotion motion;
    motion.world_from_body.rotation = Eigen::AngleAxisd(angle.z(), Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(angle.y(), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(angle.x(), Eigen::Vector3d::UnitX());
    motion.world_from_body.translation = vector(kPosition, t, 0);
    motion.velocity = vector(kPosition, t, 1);
    motion.acceleration = vector(kPosition, t, 2);
    motion.angular_velocity = rate(t);
    motion.angular_acceleration = Differentiate(rate, t);
    return motion;
  };
}

MotionFunction BendMotion(double speed, double yaw_rate) {
  return [=](double t) {
    const double yaw = yaw_rate * t;
    const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), 0), left(-ahead.y(), ahead.x(), 0);
    const double radius = std::abs(yaw_rate) > 1e-9 ? speed / yaw_rate : 0;
    const Eigen::Vector3d position =
        radius == 0 ? Eigen::Vector3d(speed * t, 0, 0)
                    : Eigen::Vector3d(radius * left * -1 + Eigen::Vector3d(0, radius, 0));
    return BodyMotion{
        {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), position},
        speed * ahead,
        speed * yaw_rate * left,
        Eigen::Vector3d(0, 0, yaw_rate),
        Eigen::Vector3d::Zero()};
  };
}

MotionFunction RestingMotion() {
  return [](double) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return BodyMotion{Rigid3{}, zero, zero, zero, zero};
  };
}

}  // namespace parkade
