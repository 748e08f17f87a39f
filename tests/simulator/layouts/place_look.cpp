#include "tests/simulator/layouts/place_look.h"

#include <span>

#include "core/error.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

/// A surface that a family may be made of: colors between two, and a texture of about a size.
struct Surface {
  Color darkest, brightest;
  TextureKind texture;
  float size, contrast;

  /// What it is where cars do not drive on it.
  SurfaceClass Kind() const {
    switch (texture) {
      case TextureKind::kGrass:
      case TextureKind::kGravel:
      case TextureKind::kMulch: return SurfaceClass::kVegetation;
      default: return SurfaceClass::kPavement;
    }
  }
};

const Surface kAsphalt{Rgb(0.06f, 0.06f, 0.06f), Rgb(0.19f, 0.185f, 0.175f),
                       TextureKind::kAggregate, 0.5f, 0.12f},
    kFreshTar{Gray(0.028f), Gray(0.06f), TextureKind::kAggregate, 0.4f, 0.2f},
    kConcrete{Rgb(0.2f, 0.195f, 0.185f), Rgb(0.36f, 0.35f, 0.33f), TextureKind::kConcrete, 9, 0.1f},
    kSlabs{Rgb(0.16f, 0.155f, 0.15f), Rgb(0.42f, 0.41f, 0.38f), TextureKind::kSlabs, 2.8f, 0.15f},
    kBricks{Rgb(0.16f, 0.08f, 0.06f), Rgb(0.32f, 0.19f, 0.15f), TextureKind::kBrick, 1.3f, 0.2f},
    kGravel{Rgb(0.14f, 0.13f, 0.11f), Rgb(0.36f, 0.33f, 0.28f), TextureKind::kGravel, 1.1f, 0.3f},
    kSoil{Rgb(0.05f, 0.035f, 0.025f), Rgb(0.16f, 0.12f, 0.08f), TextureKind::kGrass, 1.6f, 0.3f},
    kGrass{Rgb(0.05f, 0.09f, 0.025f), Rgb(0.22f, 0.3f, 0.09f), TextureKind::kGrass, 2.3f, 0.35f},
    kDryGrass{Rgb(0.16f, 0.14f, 0.06f), Rgb(0.28f, 0.25f, 0.12f), TextureKind::kGrass, 2.1f, 0.3f},
    kGranite{Rgb(0.2f, 0.2f, 0.2f), Rgb(0.42f, 0.41f, 0.39f), TextureKind::kPlaster, 0.7f, 0.12f},
    kDarkStone{Gray(0.07f), Gray(0.16f), TextureKind::kPlaster, 0.9f, 0.15f},
    // Of unknown families alone:
    kLightTiles{Rgb(0.38f, 0.36f, 0.33f), Rgb(0.58f, 0.56f, 0.52f), TextureKind::kTiles, 3.2f,
                0.07f},
    kCobbles{Rgb(0.09f, 0.09f, 0.085f), Rgb(0.24f, 0.23f, 0.21f), TextureKind::kCobbles, 1.6f,
             0.3f},
    kMulch{Rgb(0.07f, 0.04f, 0.025f), Rgb(0.2f, 0.12f, 0.07f), TextureKind::kMulch, 1.2f, 0.45f},
    kCoating{Rgb(0.2f, 0.06f, 0.045f), Rgb(0.34f, 0.13f, 0.1f), TextureKind::kPlaster, 2.5f, 0.06f},
    kGreenCoating{Rgb(0.05f, 0.12f, 0.08f), Rgb(0.1f, 0.24f, 0.16f), TextureKind::kPlaster, 2.5f,
                  0.06f},
    kPaintedStone{Rgb(0.5f, 0.36f, 0.05f), Rgb(0.6f, 0.45f, 0.08f), TextureKind::kPlaster, 0.9f,
                  0.1f},
    kPaleStone{Gray(0.4f), Gray(0.58f), TextureKind::kPlaster, 0.8f, 0.06f};

struct Family {
  const char* name;
  Surface road, kerb, pavement, island, land;
};

const Family kKnown[] = {
    {"town", kAsphalt, kGranite, kSlabs, kGrass, kGrass},
    {"brick", kAsphalt, kGranite, kBricks, kSoil, kGrass},
    {"tarred", kFreshTar, kDarkStone, kAsphalt, kGrass, kDryGrass},
    {"concrete", kConcrete, kDarkStone, kConcrete, kGravel, kGravel},
    {"country", kAsphalt, kDarkStone, kGravel, kDryGrass, kDryGrass},
    {"paved", kBricks, kGranite, kSlabs, kBricks, kSoil},
    {"plain", kAsphalt, kGranite, kAsphalt, kAsphalt, kAsphalt},
    {"pale", kConcrete, kGranite, kSlabs, kSlabs, kGrass},
};

const Family kUnknown[] = {
    {"light paving", kAsphalt, kPaleStone, kLightTiles, kLightTiles, kDryGrass},
    {"old town", kCobbles, kGranite, kLightTiles, kMulch, kSoil},
    {"coated", kFreshTar, kPaintedStone, kCoating, kMulch, kGreenCoating},
    {"dark paving", kLightTiles, kPaleStone, kCobbles, kGreenCoating, kMulch},
};

Color ColorOf(const Surface& surface, Random& random) {
  const auto share = static_cast<float>(random.Uniform());
  const Color color = surface.darkest + share * (surface.brightest - surface.darkest);
  const auto tint = [&] { return static_cast<float>(random.Uniform(0.93, 1.07)); };
  return color * Rgb(tint(), tint(), tint());
}

Material MaterialOf(const Surface& surface, Random& random) {
  return {.albedo = ColorOf(surface, random),
          .texture = surface.texture,
          .texture_size = surface.size * static_cast<float>(random.Uniform(0.6, 1.6)),
          .texture_contrast = surface.contrast * static_cast<float>(random.Uniform(0.25, 1.4)),
          .surface = surface.Kind()};
}

PlaceLook Classic() {
  PlaceLook look;
  const std::array<float, 3> tones{0.24f, 0.30f, 0.36f};
  for (std::size_t i = 0; i < tones.size(); ++i)
    look.kerbs[i] = {.albedo = Gray(tones[i]),
                     .texture = TextureKind::kPlaster,
                     .texture_size = 0.7f,
                     .texture_contrast = 0.12f,
                     .surface = SurfaceClass::kKerb};
  look.pavement = {.albedo = Rgb(0.27f, 0.26f, 0.25f),
                   .texture = TextureKind::kSlabs,
                   .texture_size = 2.4f,
                   .texture_contrast = 0.16f,
                   .surface = SurfaceClass::kPavement};
  look.land = {.albedo = Rgb(0.10f, 0.15f, 0.045f),
               .texture = TextureKind::kGrass,
               .texture_size = 2.3f,
               .texture_contrast = 0.35f,
               .surface = SurfaceClass::kVegetation};
  look.island = look.land;
  return look;
}

template <typename T>
const T& AnyOf(std::span<const T> all, Random& random) {
  return all[static_cast<std::size_t>(random.Index(static_cast<int>(all.size())))];
}

/// Each surface is some known family's.
Family Mixed(Random& random) {
  const std::span<const Family> known(kKnown);
  Family family = kKnown[0];
  family.name = "mixed";
  for (Surface Family::*part :
       {&Family::road, &Family::kerb, &Family::pavement, &Family::island, &Family::land})
    family.*part = AnyOf(known, random).*part;
  return family;
}

PlaceLook Drawn(const Family& family, Random& random) {
  PlaceLook look;
  look.family = family.name;
  look.kerb_height = random.Uniform(0.06, 0.2);
  const Material road = MaterialOf(family.road, random);
  look.road = {road.albedo, road.texture, road.texture_size, road.texture_contrast};
  const Material kerb = MaterialOf(family.kerb, random);
  for (Material& stone : look.kerbs) {
    stone = kerb;
    stone.surface = SurfaceClass::kKerb;
    stone.albedo *= static_cast<float>(random.Uniform(0.85, 1.15));
  }
  look.pavement = MaterialOf(family.pavement, random);
  look.island = MaterialOf(family.island, random);
  look.land = MaterialOf(family.land, random);
  return look;
}

}  // namespace

PlaceLook LookOf(const std::string& looks, std::uint64_t seed) {
  Random random(seed, 0x100c);
  if (looks == "known") return Drawn(AnyOf(std::span<const Family>(kKnown), random), random);
  if (looks == "mixed") return Drawn(Mixed(random), random);
  if (looks == "unknown") return Drawn(AnyOf(std::span<const Family>(kUnknown), random), random);
  Require(looks == "classic", ErrorCode::kUsage,
          "unknown looks '" + looks + "': they are classic, known, mixed or unknown");
  return Classic();
}

PlaceLook InSeason(PlaceLook look, Season season) {
  if (season == Season::kUsual) return look;
  const bool is_winter = season == Season::kWinter;
  const Color cover = is_winter ? Rgb(0.68f, 0.69f, 0.72f) : Rgb(0.24f, 0.14f, 0.045f);
  // Pavements are swept.
  const auto lay = [&](Material& ground, float share) {
    ground.albedo += share * (cover - ground.albedo);
    if (share < 0.5f) return;
    ground.texture = is_winter ? TextureKind::kPlaster : TextureKind::kLeaves;
    ground.texture_contrast = is_winter ? 0.06f : 0.5f;
    ground.surface = SurfaceClass::kVegetation;
  };
  lay(look.land, 0.95f);
  lay(look.island, 0.95f);
  lay(look.pavement, 0.3f);
  return look;
}

}  // namespace parkade::simulator
