#include "tests/bench/ground/surround_view.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/parallel.h"
#include "mapping/networks/freespace_network.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr double kTexel = 0.1, kHalfSide = 9;  // of the images that are compared
constexpr double kWide = 4;                    // blurs: what is wider is light, not paint
constexpr double kEyeHeight =
    1.2;  // of the cameras on average, to begin with: a unit is about half a meter
constexpr int kLeastShared = 500;  // texels that neighbors must both see
constexpr std::array<std::pair<size_t, size_t>, 4> kNeighbors = {{{0, 1}, {0, 3}, {2, 1}, {2, 3}}};

nlohmann::json ParamsOf(const fs::path& file) {
  return nlohmann::json::parse(ReadFile(file)).begin().value().at("param");
}

/// The published polynomial rho(theta) [px], theta from the image plane, has its inverse where
/// z(rho) = -rho tan(theta) = a0 + a2 rho^2 + a3 rho^3 + a4 rho^4.
OcamProjection FitOcam(const nlohmann::json& param, double* rms) {
  const std::vector<double> inverse = param.at("cam_dist").at("data").at(0);
  const auto radius_at = [&](double theta) {
    double radius = 0;
    for (size_t i = inverse.size(); i-- > 0;) radius = radius * theta + inverse[i];
    return radius;
  };
  std::vector<std::pair<double, double>> places;  // rho, z
  for (double theta = -0.5 * std::numbers::pi; theta < 0.15; theta += 0.002)
    if (const double radius = radius_at(theta); radius > 5)
      places.emplace_back(radius, -radius * std::tan(theta));
  Eigen::MatrixXd rows(places.size(), 4);
  Eigen::VectorXd values(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const auto& [radius, z] = places[i];
    const double weight = 1 / std::hypot(radius, z);  // of an error across the ray
    const auto row = static_cast<Eigen::Index>(i);
    rows.row(row) =
        weight * Eigen::RowVector4d(1, radius * radius, std::pow(radius, 3), std::pow(radius, 4));
    values[row] = weight * z;
  }
  const Eigen::Vector4d a = rows.colPivHouseholderQr().solve(values);
  const auto& matrix = param.at("cam_K").at("data");
  const OcamProjection ocam{.a0 = a[0],
                            .a2 = a[1],
                            .a3 = a[2],
                            .a4 = a[3],
                            .cx = matrix[0][2],
                            .cy = matrix[1][2],
                            .c = matrix[0][0],
                            .d = matrix[0][1],
                            .e = matrix[1][0]};
  double squares = 0;
  for (const auto& [radius, z] : places)
    squares += std::pow(ocam.FindRadius(radius, z) - radius, 2);
  *rms = std::sqrt(squares / static_cast<double>(places.size()));
  return ocam;
}

Rigid3 ReadPose(const nlohmann::json& param) {
  const auto& rows = param.at("sensor_calib").at("data");
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  for (int r = 0; r < 3; ++r) {
    const auto& row = rows[static_cast<size_t>(r)];
    for (int c = 0; c < 3; ++c) rotation(r, c) = row[static_cast<size_t>(c)];
    translation[r] = row[3];
  }
  return {Eigen::Quaterniond(rotation).normalized(), translation};
}

/// Where a camera sees the places of a square image of the ground; -1 where it does not.
std::pair<cv::Mat, cv::Mat> PixelsOf(const SurroundCamera& camera, double ground, double half_side,
                                     double texel) {
  const int side = static_cast<int>(std::lround(2 * half_side / texel));
  cv::Mat columns(side, side, CV_32FC1, cv::Scalar(-1)), rows = columns.clone();
  ParallelFor(static_cast<size_t>(side), [&](size_t y) {
    for (int x = 0; x < side; ++x) {
      const Eigen::Vector3d place((x + 0.5) * texel - half_side,
                                  (static_cast<double>(y) + 0.5) * texel - half_side, ground);
      const auto pixel = camera.model.Project(camera.camera_from_view * place);
      if (!pixel || !camera.model.IsInImage(*pixel, 1)) continue;
      columns.at<float>(static_cast<int>(y), x) = static_cast<float>(pixel->x());
      rows.at<float>(static_cast<int>(y), x) = static_cast<float>(pixel->y());
    }
  });
  return {columns, rows};
}

/// The ground as one camera sees it.
struct GroundView {
  cv::Mat contrast;  ///< CV_32FC1, light taken off
  cv::Mat is_seen;   ///< CV_8UC1, as drivable ground
};

GroundView Look(const SurroundCamera& camera, double ground, double blur) {
  const auto [columns, rows] = PixelsOf(camera, ground, kHalfSide, kTexel);
  cv::Mat gray, smooth, light;
  GroundView view;
  cv::cvtColor(camera.image, gray, cv::COLOR_BGR2GRAY);
  cv::remap(gray, gray, columns, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  gray.convertTo(gray, CV_32F);
  cv::remap(camera.drivable, view.is_seen, columns, rows, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  // Means over what is seen alone, so that borders show no contrast.
  cv::Mat share, wide_share, seen;
  view.is_seen.convertTo(seen, CV_32F, 1 / 255.0);
  cv::GaussianBlur(gray.mul(seen), smooth, {}, blur);
  cv::GaussianBlur(seen, share, {}, blur);
  cv::GaussianBlur(gray.mul(seen), light, {}, kWide * blur);
  cv::GaussianBlur(seen, wide_share, {}, kWide * blur);
  view.contrast = smooth / (share + 1e-3) - light / (wide_share + 1e-3);
  return view;
}

double Correlation(const GroundView& a, const GroundView& b) {
  const cv::Mat both = a.is_seen & b.is_seen;
  if (cv::countNonZero(both) < kLeastShared) return 0;
  cv::Scalar mean_a, mean_b, sigma_a, sigma_b;
  cv::meanStdDev(a.contrast, mean_a, sigma_a, both);
  cv::meanStdDev(b.contrast, mean_b, sigma_b, both);
  const double product = cv::mean(a.contrast.mul(b.contrast), both)[0];
  return (product - mean_a[0] * mean_b[0]) / std::max(1e-9, sigma_a[0] * sigma_b[0]);
}

/// The pattern search at one blur: what helps is kept.
class NeighborSearch {
 public:
  NeighborSearch(SurroundRig& rig, double blur)
      : rig_(rig), blur_(blur), views_(rig.cameras.size()) {
    LookAgain();
    best_ = Score();
  }

  void Run(double turn, double shift, int num_rounds) {
    for (int round = 0; round < num_rounds; ++round) {
      bool is_better = TryGround(shift) || TryGround(-shift);
      for (size_t camera = 1; camera < rig_.cameras.size(); ++camera)
        for (int axis = 0; axis < 6; ++axis)
          for (const double sign : {-1.0, 1.0})
            is_better |= TryCamera(camera, axis, sign * (axis < 3 ? turn : shift));
      if (!is_better) turn *= 0.5, shift *= 0.5;
    }
  }

 private:
  double Score() const {
    double sum = 0;
    for (const auto& [a, b] : kNeighbors) sum += Correlation(views_[a], views_[b]);
    return sum;
  }

  void LookAgain() {
    for (size_t i = 0; i < views_.size(); ++i)
      views_[i] = Look(rig_.cameras[i], rig_.ground, blur_);
  }

  bool Keep(const std::vector<GroundView>& before, const std::function<void()>& undo) {
    const double score = Score();
    if (score > best_) {
      best_ = score;
      return true;
    }
    views_ = before;
    undo();
    return false;
  }

  bool TryGround(double step) {
    const std::vector<GroundView> before = views_;
    const double ground = rig_.ground;
    rig_.ground += step;
    LookAgain();
    return Keep(before, [&] { rig_.ground = ground; });
  }

  bool TryCamera(size_t camera, int axis, double step) {
    const std::vector<GroundView> before = views_;
    Rigid3& pose = rig_.cameras[camera].camera_from_view;
    const Rigid3 old = pose;
    Rigid3 move;
    if (axis < 3)
      move.rotation = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(axis));
    else
      move.translation = step * Eigen::Vector3d::Unit(axis - 3);
    pose = move * pose;
    views_[camera] = Look(rig_.cameras[camera], rig_.ground, blur_);
    return Keep(before, [&] { pose = old; });
  }

  SurroundRig& rig_;
  double blur_, best_ = 0;
  std::vector<GroundView> views_;
};

}  // namespace

SurroundRig ReadOpenCalib(const fs::path& folder) {
  SurroundRig rig;
  const FreespaceNetwork network;
  for (const char* name : {"Front", "Left", "Back", "Right"}) {
    SurroundCamera& camera = rig.cameras.emplace_back();
    camera.name = name;
    camera.image = cv::imread(folder / "imgs" / (camera.name + ".png"));
    Require(!camera.image.empty(), ErrorCode::kNotFound,
            "there is no image of camera " + camera.name);
    camera.model = CameraModel(
        FitOcam(ParamsOf(folder / "intrinsic" / (camera.name + ".json")), &camera.fit_error),
        camera.image.cols, camera.image.rows);
    camera.camera_from_view = ReadPose(ParamsOf(folder / "extrinsic" / (camera.name + ".json")));
    camera.drivable = network.Run(camera.image).Mask();
    rig.ground += camera.camera_from_view.Inverse().translation.z() / 4;
  }
  rig.ground += kEyeHeight;
  return rig;
}

std::vector<double> AgreementOfNeighbors(const SurroundRig& rig, double blur) {
  std::vector<GroundView> views;
  for (const SurroundCamera& camera : rig.cameras) views.push_back(Look(camera, rig.ground, blur));
  std::vector<double> agreements;
  for (const auto& [a, b] : kNeighbors) agreements.push_back(Correlation(views[a], views[b]));
  return agreements;
}

void AlignNeighbors(SurroundRig& rig) {
  NeighborSearch(rig, 5).Run(0.04, 0.4, 12);
  NeighborSearch(rig, 2.5).Run(0.01, 0.1, 10);
  NeighborSearch(rig, 1).Run(0.004, 0.03, 8);
}

cv::Mat ViewFromAbove(const SurroundRig& rig, double half_side, double texel) {
  const int side = static_cast<int>(std::lround(2 * half_side / texel));
  cv::Mat above(side, side, CV_8UC3, cv::Scalar::all(0)),
      nearest(side, side, CV_64FC1, cv::Scalar(std::numeric_limits<double>::max()));
  for (const SurroundCamera& camera : rig.cameras) {
    const auto [columns, rows] = PixelsOf(camera, rig.ground, half_side, texel);
    cv::Mat colors, drivable;
    cv::remap(camera.image, colors, columns, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::remap(camera.drivable, drivable, columns, rows, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
    const Eigen::Vector2d eye = camera.camera_from_view.Inverse().translation.head<2>();
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        if (columns.at<float>(y, x) < 0) continue;
        const Eigen::Vector2d place((x + 0.5) * texel - half_side, (y + 0.5) * texel - half_side);
        const bool is_free = drivable.at<uchar>(y, x) > 0;
        const double distance =
            (place - eye).norm() + (is_free ? 0 : half_side);  // ground before what hides it
        if (distance >= nearest.at<double>(y, x)) continue;
        nearest.at<double>(y, x) = distance;
        cv::Vec3b& color = above.at<cv::Vec3b>(y, x) = colors.at<cv::Vec3b>(y, x);
        if (is_free)
          color = {static_cast<uchar>(0.75 * color[0]), static_cast<uchar>(0.75 * color[1] + 40),
                   static_cast<uchar>(0.75 * color[2])};
      }
  }
  return above;
}

}  // namespace parkade
