#include "server/ingest/drive/kitti_rig.h"

#include <sstream>

#include "core/error.h"
#include "core/files/file.h"
#include "core/math/statistics.h"
#include "server/ingest/files/drive_folder.h"
#include "server/ingest/files/folder_rows.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// One calib_*.txt: "key: number number ...".
class CalibrationFile {
 public:
  CalibrationFile(const fs::path& folder, const std::string& name) : name_(name) {
    for (const fs::path& place : {folder / name, folder.parent_path() / name})
      if (text_.empty() && fs::is_regular_file(place))
        text_ = "\n" + ReadFile(place, std::size_t{1} << 20);
    Require(!text_.empty(), ErrorCode::kInvalidInput,
            "no rig: " + name_ + " is missing beside the drive");
  }

  std::vector<double> Numbers(const std::string& key, std::size_t count) const {
    const std::size_t at = text_.find("\n" + key + ":");
    std::vector<double> numbers;
    if (at != std::string::npos) {
      const std::size_t begin = at + key.size() + 2;
      std::istringstream line(text_.substr(begin, text_.find('\n', begin) - begin));
      for (double number = 0; line >> number;) numbers.push_back(number);
    }
    Require(numbers.size() == count, ErrorCode::kInvalidInput,
            name_ + " needs " + std::to_string(count) + " numbers in '" + key + "'");
    return numbers;
  }

  Eigen::Matrix3d Rotation(const std::string& key) const {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(Numbers(key, 9).data());
  }

  /// R and T.
  Rigid3 Motion() const {
    return FromParts(Rotation("R"), Eigen::Map<const Eigen::Vector3d>(Numbers("T", 3).data()));
  }

  Rigid3 FromParts(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) const {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() = rotation;
    matrix.topRightCorner<3, 1>() = translation;
    try {
      return Rigid3::FromMatrix(matrix);
    } catch (const Error& error) {
      throw Error(ErrorCode::kInvalidInput, name_ + " holds a wrong motion: " + error.what());
    }
  }

 private:
  std::string name_, text_;
};

/// \param rectified_from_imu  of camera 0
RigCamera CameraOf(const CalibrationFile& lenses, int number, const Rigid3& rectified_from_imu) {
  constexpr double kMaxSide = 16384;
  const std::string suffix = (number < 10 ? "0" : "") + std::to_string(number);
  const std::vector<double> size = lenses.Numbers("S_rect_" + suffix, 2);
  const std::vector<double> projection = lenses.Numbers("P_rect_" + suffix, 12);
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(projection.data());
  const Eigen::Matrix3d lens = matrix.leftCols<3>();
  Require(size[0] >= 1 && size[0] <= kMaxSide && size[1] >= 1 && size[1] <= kMaxSide &&
              lens(0, 0) > 0 && lens(1, 1) > 0 && lens(2, 2) > 0,
          ErrorCode::kInvalidInput, "calib_cam_to_cam.txt has a wrong lens of camera " + suffix);
  const Rigid3 camera_from_rectified =
      lenses.FromParts(Eigen::Matrix3d::Identity(), lens.inverse() * matrix.col(3));
  RigCamera camera;
  camera.name = camera.topic = "cam" + std::to_string(number);
  camera.model = CameraModel(PinholeProjection{lens(0, 0), lens(1, 1), lens(0, 2), lens(1, 2)},
                             static_cast<int>(size[0]), static_cast<int>(size[1]));
  camera.body_from_camera = (camera_from_rectified * rectified_from_imu).Inverse();
  return camera;
}

/// [Hz] by the first samples: synchronized drives have a tenth of what was measured.
double RateOf(const FolderStream& imu) {
  constexpr std::size_t kEnough = 100;
  const auto rows = OpenRows(imu);
  std::vector<double> steps;
  std::optional<EurocLine> last = rows->Next();
  while (steps.size() < kEnough && last) {
    const std::optional<EurocLine> next = rows->Next();
    if (next && next->stamp > last->stamp) steps.push_back(next->stamp - last->stamp);
    last = next;
  }
  return steps.empty() ? ImuCalibration{}.update_rate : 1 / Median(std::move(steps));
}

}  // namespace

Rig ReadKittiRig(const fs::path& folder) {
  Require(fs::exists(folder / "oxts" / "timestamps.txt"), ErrorCode::kInvalidInput,
          "the log has no IMU data (oxts/timestamps.txt)");
  const CalibrationFile lenses(folder, "calib_cam_to_cam.txt");
  const Rigid3 rectified_from_imu =
      lenses.FromParts(lenses.Rotation("R_rect_00"), Eigen::Vector3d::Zero()) *
      CalibrationFile(folder, "calib_velo_to_cam.txt").Motion() *
      CalibrationFile(folder, "calib_imu_to_velo.txt").Motion();
  Rig rig;
  rig.imu.topic = "imu0";
  rig.body_from_imu.translation = {-0.05, 0.32, 0.93};
  rig.vehicle.emplace();
  rig.vehicle->wheel_topic = "odom0";
  rig.vehicle->gnss_topic = "gnss0";
  rig.vehicle->antenna_in_body = rig.body_from_imu.translation;  // fixes are the inertial unit's
  for (const FolderStream& stream : StreamsOf({folder, FolderLayout::kKitti})) {
    if (stream.kind == TableKind::kImu) rig.imu.update_rate = RateOf(stream);
    if (stream.kind != TableKind::kImages) continue;
    RigCamera camera = CameraOf(lenses, *CameraNumber(stream.topic, "cam"), rectified_from_imu);
    camera.body_from_camera = rig.body_from_imu * camera.body_from_camera;
    rig.cameras.push_back(std::move(camera));
  }
  Require(!rig.cameras.empty(), ErrorCode::kInvalidInput,
          "the log has no images (image_00/timestamps.txt)");
  ValidateRig(rig);
  return rig;
}

}  // namespace parkade
