#include "tests/simulator/layouts/place_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/error.h"

namespace parkade::simulator {
namespace {

constexpr std::uint64_t kNumPlaces = 200;

std::set<TextureKind> TexturesOf(const PlaceLook& look) {
  return {look.road.pattern, look.kerbs[0].texture, look.pavement.texture, look.island.texture,
          look.land.texture};
}

TEST(PlaceLook, UnknownFamiliesHaveSurfacesThatNoKnownOneHas) {
  std::set<std::string> known, unknown;
  std::set<TextureKind> known_textures;
  for (std::uint64_t seed = 0; seed < kNumPlaces; ++seed) {
    const PlaceLook look = LookOf("known", seed);
    known.insert(look.family);
    known_textures.merge(TexturesOf(look));
  }
  for (std::uint64_t seed = 0; seed < kNumPlaces; ++seed) {
    const PlaceLook look = LookOf("unknown", seed);
    unknown.insert(look.family);
    EXPECT_FALSE(known.contains(look.family));
    const std::set<TextureKind> textures = TexturesOf(look);
    EXPECT_TRUE(std::any_of(textures.begin(), textures.end(), [&](TextureKind texture) {
      return !known_textures.contains(texture);
    })) << look.family;
  }
  EXPECT_GE(unknown.size(), 4u);
  EXPECT_GE(3 * unknown.size(), known.size() + unknown.size()) << "a third is held back";
}

TEST(PlaceLook, MixedOnesHaveSurfacesOfKnownFamiliesInManyCombinations) {
  std::set<TextureKind> known;
  std::set<std::set<TextureKind>> combinations;
  for (std::uint64_t seed = 0; seed < kNumPlaces; ++seed)
    known.merge(TexturesOf(LookOf("known", seed)));
  for (std::uint64_t seed = 0; seed < kNumPlaces; ++seed) {
    const std::set<TextureKind> textures = TexturesOf(LookOf("mixed", seed));
    EXPECT_TRUE(std::includes(known.begin(), known.end(), textures.begin(), textures.end()));
    combinations.insert(textures);
  }
  EXPECT_GT(combinations.size(), 20u);
}

TEST(PlaceLook, NoTwoPlacesShareOneAndThePlaceKeepsItsOwn) {
  std::set<float> brightness;
  double low = 1, high = 0;
  for (std::uint64_t seed = 0; seed < kNumPlaces; ++seed) {
    const PlaceLook look = LookOf("known", seed);
    brightness.insert(Luminance(look.road.albedo));
    EXPECT_EQ(Luminance(LookOf("known", seed).pavement.albedo), Luminance(look.pavement.albedo));
    low = std::min(low, look.kerb_height);
    high = std::max(high, look.kerb_height);
  }
  EXPECT_EQ(brightness.size(), kNumPlaces);
  EXPECT_NEAR(low, 0.06, 0.005);
  EXPECT_NEAR(high, 0.2, 0.005);
}

TEST(PlaceLook, OthersAreRefused) {
  try {
    LookOf("strange", 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_STREQ(error.what(),
                 "unknown looks 'strange': they are classic, known, mixed or unknown");
  }
}

}  // namespace
}  // namespace parkade::simulator
