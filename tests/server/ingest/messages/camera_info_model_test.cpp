#include "server/ingest/messages/camera_info_model.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

CameraInfoMessage InfoOf(const std::string& model, const std::vector<double>& distortion) {
  CameraInfoMessage info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = model;
  info.distortion = distortion;
  info.intrinsic_matrix = {400, 0, 320, 0, 401, 240, 0, 0, 1};
  return info;
}

std::string Refusal(const std::string& model, const std::vector<double>& distortion) {
  try {
    ModelFromCameraInfo(InfoOf(model, distortion), false, "cam0");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CameraInfoModel, LongModelsOfOpenCvAreUsedWhereTheRestIsZero) {
  for (const char* name : {"plumb_bob", "rational_polynomial"})
    for (const std::size_t count : {5, 8, 12, 14}) {
      std::vector<double> distortion(count, 0.0);
      distortion[0] = -0.1;
      distortion[4] = 0.01;
      const CameraModel model = ModelFromCameraInfo(InfoOf(name, distortion), false, "cam0");
      const auto& lens = std::get<RadTanProjection>(model.projection());
      EXPECT_EQ(lens.distortion.k1, -0.1);
      EXPECT_EQ(lens.distortion.k3, 0.01);
    }
}

TEST(CameraInfoModel, NothingIsCutOff) {
  const std::string rest = ", which Parkade does not know: bring a rig";
  EXPECT_EQ(Refusal("rational_polynomial", {0, 0, 0, 0, 0, 0.1, 0, 0}),
            "cam0 has the distortion model rational_polynomial with a denominator" + rest);
  EXPECT_EQ(Refusal("plumb_bob", {0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0}),
            "cam0 has the distortion model plumb_bob with a thin prism" + rest);
  EXPECT_EQ(Refusal("rational_polynomial", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0}),
            "cam0 has the distortion model rational_polynomial with a tilted sensor" + rest);
  EXPECT_EQ(Refusal("equidistant", {0, 0, 0, 0, 0.1}),
            "cam0 has the distortion model equidistant with more than 4 coefficients" + rest);
}

}  // namespace
}  // namespace parkade
