#include "tests/simulator/vehicle/lens_models.h"

#include "core/error.h"

namespace parkade::simulator {
namespace {

// Each model's parameters were fitted to r = t - 0.016 t^3 + 0.0021 t^5 - 0.0011 t^7 + 0.00012 t^9
// up to 94 degrees.

MeiProjection MeiLike(const KannalaBrandtProjection& lens) {
  constexpr double kScale = 2.61103455;
  return {.xi = 1.61223022,
          .fx = kScale * lens.fx,
          .fy = kScale * lens.fy,
          .cx = lens.cx,
          .cy = lens.cy,
          .distortion = {.k1 = -0.26241738, .k2 = 0.22507009}};
}

EucmProjection EucmLike(const KannalaBrandtProjection& lens) {
  constexpr double kScale = 1.00120717;
  return {.alpha = 0.62251823,
          .beta = 1.13475291,
          .fx = kScale * lens.fx,
          .fy = kScale * lens.fy,
          .cx = lens.cx,
          .cy = lens.cy};
}

DoubleSphereProjection DoubleSphereLike(const KannalaBrandtProjection& lens) {
  constexpr double kScale = 0.72340955;
  return {.xi = -0.27853053,
          .alpha = 0.57553132,
          .fx = kScale * lens.fx,
          .fy = kScale * lens.fy,
          .cx = lens.cx,
          .cy = lens.cy};
}

OcamProjection OcamLike(const KannalaBrandtProjection& lens) {
  const double f = lens.fy;
  return {.a0 = 1.00138036 * f,
          .a2 = -0.39661731 / f,
          .a3 = 0.10486328 / (f * f),
          .a4 = -0.08807026 / (f * f * f),
          .cx = lens.cx,
          .cy = lens.cy,
          .c = lens.fx / lens.fy};
}

}  // namespace

const std::vector<std::string>& LensNames() {
  static const std::vector<std::string> names = {"kb", "omni", "eucm", "ds", "ocam"};
  return names;
}

CameraModel::Projection LensLike(const KannalaBrandtProjection& lens, const std::string& name) {
  if (name == "kb") return lens;
  if (name == "omni") return MeiLike(lens);
  if (name == "eucm") return EucmLike(lens);
  if (name == "ds") return DoubleSphereLike(lens);
  if (name == "ocam") return OcamLike(lens);
  throw Error(ErrorCode::kUsage, "rig.lens must be kb, omni, eucm, ds or ocam");
}

}  // namespace parkade::simulator
