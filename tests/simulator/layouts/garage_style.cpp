#include "tests/simulator/layouts/garage_style.h"

#include <cmath>

#include "tests/simulator/common/random.h"

namespace parkade::simulator {

GarageMeasures MeasureGarage(std::uint64_t seed) {
  Random random(seed, 0x6a9e);
  GarageMeasures garage;
  garage.is_counter = random.Chance(0.4);
  LotMeasures& deck = garage.deck;
  deck.slot_width = random.Uniform(2.42, 2.75);
  deck.num_slots = static_cast<int>(random.Uniform(38, 50) / deck.slot_width);
  deck.slot_depth = random.Uniform(4.8, 5.3);
  deck.aisle = random.Uniform(6.2, 7.1);
  deck.cross_shift = random.Index(4) - 1;
  deck.is_turned = garage.is_counter;
  if (random.Chance(0.4)) deck.slant = (garage.is_counter ? -1 : 1) * random.Uniform(0.15, 0.4);
  if (random.Chance(0.5)) {
    deck.median = random.Uniform(0.4, 1.2);
    garage.median_wall = random.Chance(0.6) ? random.Uniform(0.8, 1.2) : 2.6;
  }
  garage.storey = random.Uniform(2.8, 3.1);
  garage.ramp_share = random.Uniform();
  garage.slots_per_pillar = 2 + random.Index(3);
  garage.pillar_half = {random.Uniform(0.13, 0.2), random.Uniform(0.15, 0.4)};
  garage.pillar_inset = random.Uniform(1.3, 1.75);
  return garage;
}

GarageStyle StyleOfGarage(std::uint64_t seed) {
  const Color paints[] = {Rgb(0.10f, 0.22f, 0.40f), Rgb(0.09f, 0.30f, 0.16f),
                          Rgb(0.38f, 0.10f, 0.07f), Rgb(0.45f, 0.24f, 0.06f),
                          Rgb(0.06f, 0.28f, 0.30f), Rgb(0.24f, 0.14f, 0.30f),
                          Rgb(0.16f, 0.16f, 0.17f), Rgb(0.44f, 0.38f, 0.20f)};
  const Color pipes[] = {Rgb(0.45f, 0.05f, 0.04f), Gray(0.36f), Rgb(0.30f, 0.28f, 0.10f),
                         Rgb(0.10f, 0.16f, 0.32f)};
  Random random(seed, 0x6a57);
  const auto gray = [&](double from, double to) {
    const float level = static_cast<float>(random.Uniform(from, to)),
                warm = static_cast<float>(random.Uniform(0, 0.1));
    return Rgb(level, level * (1 - 0.3f * warm), level * (1 - warm));
  };
  GarageStyle style;
  style.paint = paints[random.Index(8)] * static_cast<float>(random.Uniform(0.85, 1.25));
  style.paint_height = random.Uniform(0.5, 1.4);
  style.concrete = gray(0.28, 0.42);
  style.ceiling = gray(0.36, 0.5);
  style.pipe = pipes[random.Index(4)];
  style.pillars = static_cast<PillarPaint>(random.Index(4));
  style.has_bays_named = random.Chance(0.6);
  style.lamp_step = random.Uniform(4.6, 7.4);
  style.lamps_lie_across = random.Chance(0.4);
  style.lamp_aside = random.Chance(0.5) ? 0 : random.Uniform(-1.6, 1.6);
  // Fewer lamps are stronger ones.
  style.lamp_strength = style.lamp_step / 6.2 * random.Uniform(0.85, 1.2);
  style.lamp_warmth = random.Uniform();
  style.pipe_aside = random.Uniform(1.4, 2.6);
  style.poster_step = random.Uniform(3.5, 7);
  return style;
}

}  // namespace parkade::simulator
