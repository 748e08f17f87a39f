#include <gtest/gtest.h>

#include <numeric>
#include <optional>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/render/renderer.h"
#include "tests/simulator/vehicle/lens_models.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

using Poses =
    std::function<Rigid3(double)>;  ///< world_from_body by time since the middle of the image [s]

/// A plate that shines: its center and half its sides [m].
struct Marker {
  Eigen::Vector3d center, right, up;
};

/// A black room around the car, in it plates that face it. They shine by themselves, so that
/// neither light nor shadow shifts their centers, and are turned about their own axes, so that no
/// edge runs along the rows of samples.
struct MarkerWorld {
  std::vector<Marker> markers;
  Scene scene{
      .place = {},
      .sky = Sky(1),
      .materials = {Material{.albedo = Gray(0)}, Material{.albedo = Gray(0), .emission = Gray(1)}}};

  /// `is_white`: walls shine, too, which shows how much light arrives at each pixel.
  explicit MarkerWorld(const Rigid3& world_from_body, bool is_white = false) {
    if (is_white) scene.materials[0].emission = Gray(1);
    const Eigen::Vector3d& car = world_from_body.translation;
    for (const double side : {-1.0, 1.0}) {
      scene.objects.AddBox(car + Eigen::Vector3d(15 * side, 0, 5), {0.1, 15, 9}, 0, 0);
      scene.objects.AddBox(car + Eigen::Vector3d(0, 15 * side, 5), {15, 0.1, 9}, 0, 0);
    }
    scene.objects.AddBox(car - Eigen::Vector3d(0, 0, 2), {15, 15, 0.1}, 0, 0);
    for (int i = 0; i < 36; ++i) {
      const double azimuth = 2 * M_PI * i / 36, distance = 5 + 0.7 * (i % 4),
                   half = 0.034 * distance;
      const Eigen::Vector3d center(1.3 + distance * std::cos(azimuth), distance * std::sin(azimuth),
                                   0.35 + 0.6 * (i % 3));
      const Eigen::Vector3d front = (Eigen::Vector3d(1.3, 0, 0.8) - center).normalized();
      const Eigen::AngleAxisd roll(0.37 + 0.61 * i, front);
      const Eigen::Vector3d right =
          half * (roll * Eigen::Vector3d::UnitZ().cross(front).normalized());
      Add({world_from_body * center, world_from_body.rotation * right,
           world_from_body.rotation * front.cross(right)});
    }
  }

  void Add(const Marker& marker) {
    markers.push_back(marker);
    const auto& [center, right, up] = marker;
    scene.objects.AddQuad(
        {center - right - up, center + right - up, center + right + up, center - right + up}, 1);
  }
};

/// Where a marker is, and how far around it to look [px].
struct Patch {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double reach = 0;
};

/// Center of the marker within a patch of an image in which 1 is its light: each pixel weighs by
/// how many of its samples are on it. Nothing when it is not there, or the own car or the rim may
/// cut it.
std::optional<Eigen::Vector2d> MarkerIn(const cv::Mat& share, const Patch& patch) {
  const int reach = static_cast<int>(patch.reach) + 3;
  const int column = static_cast<int>(std::lround(patch.center.x())),
            row = static_cast<int>(std::lround(patch.center.y()));
  const cv::Rect window(column - reach, row - reach, 2 * reach + 1, 2 * reach + 1);
  if ((window & cv::Rect(0, 0, share.cols, share.rows)) != window) return std::nullopt;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double num_samples = 0, most = 0;
  for (int y = window.y; y < window.br().y; ++y) {
    for (int x = window.x; x < window.br().x; ++x) {
      if (share.at<float>(y, x) < 0) return std::nullopt;
      const double samples = std::round(kSamplesPerEdgePixel * share.at<float>(y, x));
      sum += samples * Eigen::Vector2d(x, y);
      num_samples += samples;
      most = std::max(most, samples);
    }
  }
  if (most < kSamplesPerEdgePixel) return std::nullopt;
  return Eigen::Vector2d(sum / num_samples);
}

/// The share of light that the markers give, CV_32FC1; negative where the own car or the rim of the
/// lens is.
cv::Mat ShareOf(const cv::Mat& radiance, const cv::Mat& white, const cv::Mat& mask) {
  cv::Mat share(radiance.size(), CV_32FC1, cv::Scalar(-1));
  for (int y = 0; y < share.rows; ++y)
    for (int x = 0; x < share.cols; ++x)
      if (mask.at<std::uint8_t>(y, x))
        share.at<float>(y, x) = radiance.at<cv::Vec3f>(y, x)[1] / white.at<cv::Vec3f>(y, x)[1];
  return share;
}

/// Where a point of the world appears when the car drives and the shutter rolls.
std::optional<Eigen::Vector2d> Project(const RigCamera& camera, const Poses& world_from_body,
                                       const Eigen::Vector3d& point) {
  double offset = 0;
  std::optional<Eigen::Vector2d> pixel;
  for (int iteration = 0; iteration < 5; ++iteration) {
    pixel =
        camera.model.Project((world_from_body(offset) * camera.body_from_camera).Inverse() * point);
    if (!pixel) return std::nullopt;
    offset = camera.line_delay * (pixel->y() - (camera.model.height() - 1) / 2.0);
  }
  return pixel;
}

/// Center of the image of a whole marker: the mean over its cells, each by the area of its image.
std::optional<Patch> ProjectMarker(const RigCamera& camera, const Poses& world_from_body,
                                   const Marker& marker) {
  constexpr int kCells = 6;
  std::array<std::array<Eigen::Vector2d, kCells + 1>, kCells + 1> grid;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const Eigen::Vector3d offset =
          (2.0 * i / kCells - 1) * marker.right + (2.0 * j / kCells - 1) * marker.up;
      const auto pixel = Project(camera, world_from_body, marker.center + offset);
      if (!pixel) return std::nullopt;
      grid[static_cast<size_t>(i)][static_cast<size_t>(j)] = *pixel;
    }
  }
  Patch patch;
  double area_sum = 0;
  for (size_t i = 0; i < kCells; ++i) {
    for (size_t j = 0; j < kCells; ++j) {
      const Eigen::Vector2d a = grid[i + 1][j + 1] - grid[i][j],
                            b = grid[i][j + 1] - grid[i + 1][j];
      const double area = std::abs(a.x() * b.y() - a.y() * b.x());
      patch.center +=
          area / 4 * (grid[i][j] + grid[i + 1][j] + grid[i][j + 1] + grid[i + 1][j + 1]);
      area_sum += area;
    }
  }
  patch.center /= area_sum;
  for (const auto& corner : {grid[0][0], grid[0][kCells], grid[kCells][0], grid[kCells][kCells]})
    patch.reach = std::max(patch.reach, (corner - patch.center).norm());
  return patch;
}

struct MarkerErrors {
  std::array<int, 4> count{};              ///< markers seen, per camera
  double worst = 0, root_mean_square = 0;  ///< [px] over all markers of all images
};

/// The images to take: the first with its middle at time 0, the others a little later.
struct Images {
  Poses world_from_body;
  double exposure = 0;  ///< [s]
  int count = 1;
  double step = 0.0023;  ///< [s] between them

  Poses PosesOf(int image) const {
    return [this, image](double offset) { return world_from_body(image * step + offset); };
  }
};

/// How far a marker is from where it should be in an image [px]; nothing where it is not in the
/// image whole.
std::optional<double> MarkerError(const RigCamera& camera, const Poses& world_from_body,
                                  const cv::Mat& share, const Marker& marker) {
  constexpr double kWidest = 1.45;  // [rad] to the axis: beyond it the rim of the lens cuts plates
  const auto expected = ProjectMarker(camera, world_from_body, marker);
  const auto bearing = expected ? camera.model.Unproject(expected->center) : std::nullopt;
  if (!bearing || bearing->z() < std::cos(kWidest)) return std::nullopt;
  const auto seen = MarkerIn(share, *expected);
  if (!seen) return std::nullopt;
  return (*seen - expected->center).norm();
}

cv::Mat Take(const Renderer& renderer, size_t camera, const Poses& world_from_body,
             double exposure) {
  Shot shot;
  shot.camera = camera;
  shot.world_from_body = world_from_body;
  shot.exposure = exposure;
  return renderer.Render(shot).radiance;
}

MarkerErrors CompareMarkers(const Rig& rig, const Images& images) {
  const MarkerWorld world(images.world_from_body(0)), white_world(images.world_from_body(0), true);
  const Renderer renderer(world.scene, rig, kHalfFieldOfView),
      white(white_world.scene, rig, kHalfFieldOfView);
  MarkerErrors errors;
  double sum_squares = 0;
  int count = 0;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const cv::Mat all = Take(white, camera, images.PosesOf(0), 0), mask = renderer.Mask(camera);
    for (int image = 0; image < images.count; ++image) {
      const Poses world_from_body = images.PosesOf(image);
      const cv::Mat share =
          ShareOf(Take(renderer, camera, world_from_body, images.exposure), all, mask);
      for (const Marker& marker : world.markers) {
        const auto error = MarkerError(rig.cameras[camera], world_from_body, share, marker);
        if (!error) continue;
        errors.worst = std::max(errors.worst, *error);
        sum_squares += *error * *error;
        ++errors.count[camera];
        ++count;
      }
    }
  }
  errors.root_mean_square = std::sqrt(sum_squares / std::max(1, count));
  return errors;
}

void ExpectExact(const MarkerErrors& errors, int num_images) {
  for (size_t camera = 0; camera < errors.count.size(); ++camera)
    EXPECT_GE(errors.count[camera], 10 * num_images) << camera;
  EXPECT_LE(errors.worst, 0.1);
  EXPECT_LT(errors.root_mean_square, 0.022);
  testing::Test::RecordProperty(
      "markers", std::to_string(std::accumulate(errors.count.begin(), errors.count.end(), 0)));
  testing::Test::RecordProperty("worst_px", std::to_string(errors.worst));
  testing::Test::RecordProperty("rms_px", std::to_string(errors.root_mean_square));
}

class ReprojectionOfLens : public testing::TestWithParam<std::string> {};

TEST_P(ReprojectionOfLens, AMarkerAppearsWhereTheCameraModelProjectsIt) {
  const Rigid3 pose{ExpSo3({0.01, -0.02, 0.3}), {0.2, -0.1, 0.03}};
  RigOptions options;
  options.lens = GetParam();

  ExpectExact(CompareMarkers(MakeSimulatedRig(options, 4),
                             {.world_from_body = [&](double) { return pose; }}),
              1);
}

INSTANTIATE_TEST_SUITE_P(Models, ReprojectionOfLens, testing::ValuesIn(LensNames()),
                         [](const auto& info) { return info.param; });

/// The moments of a drive at which the largest errors are to be feared: the fastest, the sharpest
/// turn, the hardest braking.
std::array<double, 3> HardMoments(const Motion& motion) {
  const auto hardness = [&](double time) -> std::array<double, 3> {
    const MotionState state = motion.At(time);
    return {state.velocity_in_world.norm(), state.angular_velocity_in_body.norm(),
            -state.acceleration_in_world.dot(state.velocity_in_world.normalized())};
  };
  std::array<double, 3> moments, hardest;
  moments.fill(3);
  hardest.fill(-1e9);
  for (double time = 3; time < motion.Duration() - 3; time += 0.1)
    for (size_t kind = 0; kind < moments.size(); ++kind)
      if (hardness(time)[kind] > hardest[kind]) {
        hardest[kind] = hardness(time)[kind];
        moments[kind] = time;
      }
  return moments;
}

/// Drives through the scenes: with slopes, bumps of the road, a body that leans, and a shutter that
/// rolls.
class ReprojectionWhileDriving : public testing::TestWithParam<std::tuple<const char*, int>> {};

TEST_P(ReprojectionWhileDriving, MotionAndRollingShutterMoveAMarkerAsTheTruthSays) {
  constexpr int kNumImages = 3;
  const auto& [scene, number] = GetParam();
  const std::uint64_t seed = static_cast<std::uint64_t>(number);
  RigOptions options;
  options.line_delay = 5e-5;
  const Rig rig = MakeSimulatedRig(options, seed);
  const DrivePlan plan =
      PlanDrive(PlanPlace(scene, {.seed = seed}), {.length = 300, .stops = {}}, 0, seed);

  for (const double time : HardMoments(plan.motion)) {
    SCOPED_TRACE(time);
    const Poses world_from_body = [&](double offset) {
      return plan.motion.WorldFromBody(time + offset);
    };
    ExpectExact(
        CompareMarkers(
            rig, {.world_from_body = world_from_body, .exposure = 0.004, .count = kNumImages}),
        kNumImages);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ReprojectionWhileDriving,
                         testing::Combine(testing::Values("lot", "garage", "street"),
                                          testing::Values(5, 6)),
                         [](const auto& info) {
                           return std::get<0>(info.param) +
                                  ("_" + std::to_string(std::get<1>(info.param)));
                         });

}  // namespace
}  // namespace parkade::simulator
