#include "server/ingest/messages/camera_info_model.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

struct Focal {
  double fx, fy, cx, cy;
};

CameraModel::Projection RadTan(const Focal& f, const std::vector<double>& d) {
  const auto at = [&](std::size_t i) { return i < d.size() ? d[i] : 0.0; };
  return RadTanProjection{
      .fx = f.fx,
      .fy = f.fy,
      .cx = f.cx,
      .cy = f.cy,
      .distortion = {.k1 = at(0), .k2 = at(1), .p1 = at(2), .p2 = at(3), .k3 = at(4)}};
}

/// Nothing of a lens may be cut off: what comes behind the coefficients that are used must be 0.
void RequireNoMore(const CameraInfoMessage& info, std::size_t num_used, const std::string& camera) {
  const std::vector<double>& d = info.distortion;
  std::size_t place = num_used;
  while (place < d.size() && d[place] == 0) ++place;
  if (place >= d.size()) return;
  const bool is_of_opencv = num_used == 5;  // k1 k2 p1 p2 k3, k4 k5 k6, s1 ... s4, tilt
  const char* what = !is_of_opencv ? "more than 4 coefficients"
                     : place < 8   ? "a denominator"
                     : place < 12  ? "a thin prism"
                                   : "a tilted sensor";
  throw Error(ErrorCode::kInvalidInput, camera + " has the distortion model " +
                                            info.distortion_model + " with " + what +
                                            ", which Parkade does not know: bring a rig");
}

CameraModel::Projection Distorted(const Focal& f, const CameraInfoMessage& info,
                                  const std::string& camera) {
  const std::vector<double>& d = info.distortion;
  const std::string& name = info.distortion_model;
  const bool is_zero = std::all_of(d.begin(), d.end(), [](double value) { return value == 0; });
  if (name == "none" || (name.empty() && is_zero)) return PinholeProjection{f.fx, f.fy, f.cx, f.cy};
  if (name == "plumb_bob" || name == "rational_polynomial") {
    RequireNoMore(info, 5, camera);
    return RadTan(f, d);
  }
  if (name == "equidistant" || name == "fisheye" || name == "kannala_brandt") {
    Require(
        d.size() >= 4, ErrorCode::kInvalidInput,
        camera + " has fewer than the 4 distortion coefficients of " + name + " in its CameraInfo");
    RequireNoMore(info, 4, camera);
    return KannalaBrandtProjection{.fx = f.fx,
                                   .fy = f.fy,
                                   .cx = f.cx,
                                   .cy = f.cy,
                                   .k1 = d[0],
                                   .k2 = d[1],
                                   .k3 = d[2],
                                   .k4 = d[3]};
  }
  throw Error(ErrorCode::kInvalidInput, camera + " has the distortion model '" +
                                            name.substr(0, 40) +
                                            "', which Parkade does not know: bring a rig");
}

}  // namespace

CameraModel ModelFromCameraInfo(const CameraInfoMessage& info, bool is_rectified,
                                const std::string& camera) {
  const auto& k = info.intrinsic_matrix;
  const auto& p = info.projection_matrix;
  const Focal focal = is_rectified ? Focal{p[0], p[5], p[2], p[6]} : Focal{k[0], k[4], k[2], k[5]};
  Require(focal.fx > 0 && focal.fy > 0, ErrorCode::kInvalidInput,
          camera + " is not calibrated: the focal length in its CameraInfo is 0");
  constexpr std::uint32_t kMaxSide = 16384;
  Require(info.width > 0 && info.width <= kMaxSide && info.height > 0 && info.height <= kMaxSide,
          ErrorCode::kInvalidInput, camera + " has no image size in its CameraInfo");
  try {
    return CameraModel(is_rectified ? PinholeProjection{focal.fx, focal.fy, focal.cx, focal.cy}
                                    : Distorted(focal, info, camera),
                       static_cast<int>(info.width), static_cast<int>(info.height));
  } catch (const Error& error) {
    const std::string what = error.what();
    throw Error(ErrorCode::kInvalidInput,
                what.starts_with(camera) ? what : camera + " has a wrong CameraInfo: " + what);
  }
}

}  // namespace parkade
