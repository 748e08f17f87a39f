#include "tests/slam/worlds/real_clip.h"

#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

namespace parkade {

std::vector<std::vector<std::string>> ReadCsv(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

namespace {

RealClip LoadMav(const std::filesystem::path& folder, std::vector<RigCamera> cameras) {
  RealClip clip;
  clip.cameras = std::move(cameras);
  for (size_t i = 0; i < clip.cameras.size(); ++i) {
    const std::filesystem::path camera = folder / "mav0" / ("cam" + std::to_string(i));
    clip.times.emplace_back();
    clip.images.emplace_back();
    for (const auto& row : ReadCsv(camera / "data.csv")) {
      clip.times.back().push_back(Timestamp{std::stoll(row.at(0))});
      clip.images.back().push_back(camera / "data" / row.at(1));
    }
  }
  for (const auto& row : ReadCsv(folder / "mav0" / "imu0" / "data.csv")) {
    const auto number = [&](size_t i) { return std::stod(row.at(i)); };
    clip.imu.push_back({Timestamp{std::stoll(row.at(0))},
                        {number(1), number(2), number(3)},
                        {number(4), number(5), number(6)}});
  }
  return clip;
}

RigCamera MakeCamera(const std::string& name, const CameraModel& model,
                     const Eigen::Matrix4d& imu_from_camera) {
  RigCamera camera;
  camera.name = name;
  camera.model = model;
  camera.body_from_camera = Rigid3::FromMatrix(imu_from_camera);
  return camera;
}

std::vector<RigCamera> EurocCameras() {
  Eigen::Matrix4d left, right;
  left << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,          //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,      //
      0, 0, 0, 1;
  right << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
      0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,         //
      -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038,       //
      0, 0, 0, 1;
  const RadTanProjection left_lens{
      .fx = 458.654,
      .fy = 457.296,
      .cx = 367.215,
      .cy = 248.375,
      .distortion = {.k1 = -0.28340811, .k2 = 0.07395907, .p1 = 0.00019359, .p2 = 1.76187114e-05}};
  const RadTanProjection right_lens{
      .fx = 457.587,
      .fy = 456.134,
      .cx = 379.999,
      .cy = 255.238,
      .distortion = {
          .k1 = -0.28368365, .k2 = 0.07451284, .p1 = -0.00010473, .p2 = -3.55590700e-05}};
  return {MakeCamera("cam0", {left_lens, 752, 480}, left),
          MakeCamera("cam1", {right_lens, 752, 480}, right)};
}

}  // namespace

CameraFrame RealClip::Frame(size_t camera, size_t index) const {
  return {times[camera][index], static_cast<int>(camera),
          cv::imread(images[camera][index].string(), cv::IMREAD_GRAYSCALE)};
}

Eigen::Matrix3d RealClip::Rotation(size_t camera, Timestamp from, Timestamp to) const {
  Eigen::Quaterniond from_imu_to_imu =
      Eigen::Quaterniond::Identity();  // imu at `from` from imu later
  for (size_t i = 0; i + 1 < imu.size(); ++i) {
    const Timestamp begin = std::max(from, imu[i].time), end = std::min(to, imu[i + 1].time);
    if (begin >= end) continue;
    const Eigen::Vector3d rate = 0.5 * (imu[i].angular_velocity + imu[i + 1].angular_velocity);
    from_imu_to_imu = from_imu_to_imu * ExpSo3(rate * (end - begin));
  }
  const Eigen::Quaterniond imu_from_camera = cameras[camera].body_from_camera.rotation;
  return (imu_from_camera.conjugate() * from_imu_to_imu.conjugate() * imu_from_camera)
      .toRotationMatrix();
}

std::optional<std::filesystem::path> FindSharedData(const std::string& name) {
  const char* variable = std::getenv("PARKADE_SHARED_DATA");
  const std::filesystem::path folder = variable != nullptr ? variable : "../shared/data";
  if (!std::filesystem::exists(folder / name)) return std::nullopt;
  return folder / name;
}

std::optional<RealClip> LoadKittiClip() {
  const auto folder = FindSharedData("kitti_06_clip");
  if (!folder) return std::nullopt;
  const CameraModel lens(
      PinholeProjection{.fx = 707.0912, .fy = 707.0912, .cx = 601.8873, .cy = 183.1104}, 1226, 370);
  std::vector<RigCamera> cameras;
  for (const double x : {-0.314076870, -0.851227523}) {
    Eigen::Matrix4d camera_from_imu;
    camera_from_imu << 0.000998747, -0.999990382, 0.004259378, x,  //
        0.008416902, -0.004250821, -0.999955570, 0.719452036,      //
        0.999964049, 0.001034553, 0.008412575, -1.089082940,       //
        0, 0, 0, 1;
    cameras.push_back(MakeCamera("cam" + std::to_string(cameras.size()), lens,
                                 Rigid3::FromMatrix(camera_from_imu).Inverse().Matrix()));
  }
  return LoadMav(*folder, cameras);
}

std::optional<RealClip> LoadEurocStill() {
  const auto folder = FindSharedData("euroc_v101_clip");
  if (!folder) return std::nullopt;
  return LoadMav(*folder, EurocCameras());
}

std::optional<RealClip> LoadEurocFlight() {
  const auto folder = FindSharedData("euroc_v101_moving");
  if (!folder) return std::nullopt;
  return LoadMav(*folder, {EurocCameras().front()});
}

}  // namespace parkade
