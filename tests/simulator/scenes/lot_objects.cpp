#include "tests/simulator/scenes/lot_objects.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHorizon = 160;  // [m] of green around the lot

class LotFurnisher {
 public:
  LotFurnisher(const LotLayout& layout, Props& props) : layout_(layout), props_(props) {}

  void Green() {
    const auto lines = [](double length) {
      std::vector<double> places;
      for (double x = -kHorizon; x < 0; x += x < -20 ? 5 : 1) places.push_back(std::min(x, 0.0));
      const int num_inside = static_cast<int>(length) + 1;
      for (int i = 0; i < num_inside; ++i) places.push_back(length * i / num_inside);
      for (double x = 0; x < kHorizon; x += x < 20 ? 1 : 5) places.push_back(length + x);
      return places;
    };
    const std::vector<double> xs = lines(layout_.length), ys = lines(layout_.width);
    for (size_t j = 0; j + 1 < ys.size(); ++j) {
      for (size_t i = 0; i + 1 < xs.size(); ++i) {
        const Vector2d middle((xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2);
        if (middle.x() > 0 && middle.y() > 0 && middle.x() < layout_.length &&
            middle.y() < layout_.width)
          continue;
        props_.mesh().AddQuad(
            {props_.OnGreen(xs[i], ys[j]), props_.OnGreen(xs[i + 1], ys[j]),
             props_.OnGreen(xs[i + 1], ys[j + 1]), props_.OnGreen(xs[i], ys[j + 1])},
            props_.land());
      }
    }
  }

  void Islands() {
    for (const Rectangle& island : layout_.islands) {
      props_.KerbAround(island, false);
      const int rows = 2 + static_cast<int>(2 * island.half_size.y());
      const Vector2d low = island.center - island.half_size, size = 2 * island.half_size;
      props_.mesh().AddSheet(
          2, rows,
          [&](int i, int j) {
            return props_.OnGreen(low.x() + size.x() * i, low.y() + size.y() * j / (rows - 1));
          },
          [&](int, int) { return props_.island(); });
      if (island.half_size.y() > 2) {
        for (const double y : {-0.6, 0.55})
          props_.Tree(island.center + Vector2d(0, y * island.half_size.y()),
                      props_.random().Uniform(4, 6));
        props_.StreetLamp(island.center);
        for (int i = 0; i < 5; ++i)
          props_.Bush(
              island.center + Vector2d(props_.random().Uniform(-0.4, 0.4),
                                       props_.random().Uniform(-0.9, 0.9) * island.half_size.y()),
              props_.random().Uniform(0.25, 0.5));
      } else {
        props_.random().Chance(0.5) ? props_.StreetLamp(island.center)
                                    : props_.Tree(island.center, props_.random().Uniform(3.5, 5));
      }
    }
  }

  void Cars() {
    for (const ParkedCar& car : layout_.cars) props_.Car(car.footprint, 0, car.style, car.seed);
  }

  void Heaps() {
    for (const Rectangle& heap : layout_.heaps) props_.Heap(heap);
  }

  void Surroundings() {
    const double length = layout_.length, width = layout_.width;
    const bool hedge_in_south = props_.random().Chance(0.5);
    props_.Hedge({1, hedge_in_south ? -1.4 : width + 1.4},
                 {length - 1, hedge_in_south ? -1.4 : width + 1.4});
    props_.Fence({-1, hedge_in_south ? width + 1.2 : -1.2},
                 {length + 1, hedge_in_south ? width + 1.2 : -1.2});
    for (const double y : {-4.5, width + 4.5})
      for (double x = props_.random().Uniform(-4, 4); x < length + 5;
           x += props_.random().Uniform(5, 13))
        props_.Tree({x, y + props_.random().Uniform(-1, 1)}, props_.random().Uniform(4.5, 8));
    for (const double x : {-3.5, length + 3.5}) {
      for (double y = props_.random().Uniform(0, 4); y < width;
           y += props_.random().Uniform(4, 9)) {
        const int kind = props_.random().Index(4);
        if (kind == 0) props_.Tree({x, y}, props_.random().Uniform(4, 7));
        if (kind == 1) props_.Bush({x, y}, props_.random().Uniform(0.5, 1.1));
        if (kind == 2) props_.Sign({x > 0 ? length + 0.6 : -0.6, y}, x > 0 ? M_PI : 0);
        if (kind == 3) props_.Bin({x, y});
      }
      for (double y = 1; y < width; y += props_.random().Uniform(1.4, 1.8))
        props_.Bollard({x > 0 ? length + 0.4 : -0.4, y});
    }
    for (double x = 12; x < length - 10; x += props_.random().Uniform(9, 16)) {
      props_.Sign({x, -0.5}, M_PI / 2);
      props_.Sign({x + 3, width + 0.5}, -M_PI / 2);
    }
  }

  void Town() {
    const Vector2d middle(layout_.length / 2, layout_.width / 2);
    for (int side = 0; side < 4; ++side) {
      const Vector2d out = side == 0   ? Vector2d(0, -1)
                           : side == 1 ? Vector2d(1, 0)
                           : side == 2 ? Vector2d(0, 1)
                                       : Vector2d(-1, 0);
      const Vector2d along(-out.y(), out.x());
      const double reach = std::abs(out.dot(middle)), span = std::abs(along.dot(middle)) + 12;
      for (double place = -span; place < span;) {
        const double half_front = props_.random().Uniform(5, 13),
                     half_depth = props_.random().Uniform(4, 8),
                     gap = props_.random().Uniform(1.5, 9);
        Building(middle + out * (reach + props_.random().Uniform(7.5, 13) + half_depth) +
                     along * (place + half_front),
                 {half_front, half_depth}, along, props_.random().Uniform(3.6, 12), true);
        place += 2 * half_front + gap;
      }
      for (double place = -span - 60; place < span + 60;) {
        const double half_front = props_.random().Uniform(6, 18);
        Building(
            middle + out * (reach + props_.random().Uniform(45, 90)) + along * (place + half_front),
            {half_front, 6}, along, props_.random().Uniform(10, 32), false);
        place += 2 * half_front + props_.random().Uniform(2, 14);
      }
    }
  }

 private:
  void Building(const Vector2d& center, const Vector2d& half_size, const Vector2d& along,
                double height, bool is_detailed) {
    const double yaw = std::atan2(along.y(), along.x()) + props_.random().Uniform(-0.06, 0.06);
    props_.Building({center, half_size, yaw}, height, is_detailed);
  }

  const LotLayout& layout_;
  Props& props_;
};

}  // namespace

void FurnishLot(const LotLayout& layout, Props& props) {
  LotFurnisher furnisher(layout, props);
  furnisher.Green();
  const Vector2d half(layout.length / 2, layout.width / 2);
  props.KerbAround({half, half, 0}, true);
  furnisher.Islands();
  furnisher.Surroundings();
  furnisher.Town();
  furnisher.Cars();
  furnisher.Heaps();
}

}  // namespace parkade::simulator
