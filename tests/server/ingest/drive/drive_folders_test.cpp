#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "core/error.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/files/drive_folder.h"
#include "server/ingest/files/euroc_csv.h"
#include "server/ingest/inspection/inspect_log.h"
#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/support/archive_writer.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

template <typename T>
std::vector<T> ReadAll(const DriveLog& log) {
  std::vector<T> records;
  const auto stream = log.Read({});
  while (const auto record = stream->Next())
    if (const T* found = std::get_if<T>(&*record)) records.push_back(*found);
  return records;
}

std::string WhatOpeningThrows(const fs::path& log, const OpenLogOptions& options = {}) {
  try {
    OpenDriveLog(log, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

std::string Padded(int number, int digits) {
  const std::string text = std::to_string(number);
  return std::string(static_cast<std::size_t>(digits) - text.size(), '0') + text;
}

/// Two seconds of KITTI raw: IMU and two cameras of 64 x 48 at 10 Hz, 12 m/s.
void WriteKittiFolder(const fs::path& date, const std::string& extension = ".png") {
  const fs::path drive = date / "2011_09_26_drive_0013_sync";
  std::string stamps;
  for (int i = 0; i <= 20; ++i) {
    stamps +=
        "2011-09-26 13:10:" + Padded(51 + i / 10, 2) + "." + std::to_string(i % 10) + "75862102\n";
    std::string packet =
        "49.01" + std::to_string(10 + i) + " 8.4378 114.0 0.1 0.2 0.3 1 2 12.5 0.1 0.2";
    packet += " 0.5 0.25 9.75 7 7 7";      // x, y, z; forward, left, up
    packet += " 0.01 0.02 0.03 8 8 8";     // alike
    packet += " 0.15 0.01 4 8 4 4 0\r\n";  // accuracy, status
    WriteText(drive / "oxts" / "data" / (Padded(i, 10) + ".txt"), packet);
    for (const int camera : {0, 2}) {
      const fs::path data = drive / ("image_0" + std::to_string(camera)) / "data";
      fs::create_directories(data);
      cv::imwrite((data / (Padded(i, 10) + extension)).string(), NumberedImage(camera / 2, i));
    }
  }
  for (const char* sensor : {"oxts", "image_00", "image_02"})
    WriteText(drive / sensor / "timestamps.txt", stamps);
  WriteText(drive / "velodyne_points" / "timestamps.txt", stamps);
  WriteText(date / "calib_cam_to_cam.txt",
            "calib_time: 09-Jan-2012 13:57:47\nS_rect_00: 64 48\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
            "P_rect_00: 40 0 31.5 0 0 40 23.5 0 0 0 1 0\nS_rect_02: 64 48\n"
            "P_rect_02: 40 0 31.5 2.4 0 40 23.5 0 0 0 1 0\n");
  WriteText(date / "calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n");
  WriteText(date / "calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.81 0.32 -0.8\n");
}

void ExpectKittiDrive(const RecordedDrive& log) {
  const auto imu = ReadAll<ImuSample>(log);
  ASSERT_EQ(imu.size(), 21u);
  EXPECT_EQ(imu[13].time.ns, 1'317'042'652'375'862'102);
  EXPECT_EQ(imu[13].angular_velocity, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(imu[13].linear_acceleration, Eigen::Vector3d(0.5, 0.25, 9.75));
  const auto wheels = ReadAll<WheelSample>(log);
  ASSERT_EQ(wheels.size(), 21u);
  EXPECT_EQ(wheels[0].forward_speed, 12.5);
  EXPECT_EQ(wheels[0].yaw_rate, 0.03);
  const auto fixes = ReadAll<GnssFix>(log);
  ASSERT_EQ(fixes.size(), 21u);
  EXPECT_EQ(fixes[20].latitude_deg, 49.0130);
  EXPECT_EQ(fixes[20].sigma_enu, Eigen::Vector3d(0.15, 0.15, 0.3));
  const auto frames = ReadAll<CameraFrame>(log);
  ASSERT_EQ(frames.size(), 42u);
  EXPECT_EQ(frames[41].time.ns, 1'317'042'653'075'862'102);
}

TEST(KittiFolder, GivesImuWheelsFixesAndImages) {
  const TestFolder folder;
  WriteKittiFolder(folder.path() / "2011_09_26");

  const auto log = OpenDriveLog(folder.path() / "2011_09_26");

  ExpectKittiDrive(*log);
  EXPECT_TRUE(log->health().damage.IsClean());
  for (const CameraFrame& frame : ReadAll<CameraFrame>(*log)) {
    const auto index = static_cast<int>((frame.time.ns - 1'317'042'651'075'862'102) / 100'000'000);
    EXPECT_EQ(cv::norm(frame.image, NumberedImage(frame.camera, index), cv::NORM_INF), 0);
  }
}

TEST(KittiFolder, BringsItsRig) {
  const TestFolder folder;
  WriteKittiFolder(folder.path());

  const Rig rig = OpenDriveLog(folder.path())->rig();

  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].name, "cam2");
  EXPECT_NEAR(rig.imu.update_rate, 10, 1e-6);
  // Camera 0 looks forward, 0.27 m before the lidar and 0.08 m above it, 1.08 m before the IMU.
  const Rigid3 imu_from_camera = rig.ImuFromCamera(0);
  EXPECT_TRUE(imu_from_camera.translation.isApprox(Eigen::Vector3d(1.08, -0.32, 0.72), 1e-9));
  EXPECT_TRUE((imu_from_camera.rotation * Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d::UnitX(), 1e-9));
  // Camera 2 stands 0.06 m left of it.
  EXPECT_TRUE(rig.ImuFromCamera(1).translation.isApprox(Eigen::Vector3d(1.08, -0.26, 0.72), 1e-9));
  EXPECT_TRUE(rig.body_from_imu.translation.isApprox(Eigen::Vector3d(-0.05, 0.32, 0.93), 1e-9));
}

TEST(KittiFolder, MayBeAnArchive) {
  const TestFolder folder;
  WriteKittiFolder(folder.path() / "2011_09_26", ".jpg");
  for (const std::string kind : {"zip", "tar.gz"}) {
    const fs::path file = folder.path() / ("drive_" + kind);
    WriteArchive(file, kind, EntriesOf(folder.path() / "2011_09_26", "2011_09_26/"));

    const auto log = OpenDriveLog(file, {.scratch_folder = folder.path()});

    ExpectKittiDrive(*log);
    EXPECT_EQ(InspectLog(file, {}, folder.path()).format, "KITTI raw archive");
  }
}

TEST(KittiFolder, WhatIsMissingIsNamed) {
  const TestFolder folder;
  const fs::path drive = folder.path() / "2011_09_26_drive_0013_sync";
  WriteKittiFolder(folder.path());
  fs::remove(drive / "oxts" / "data" / "0000000003.txt");
  const auto log = OpenDriveLog(folder.path());

  EXPECT_EQ(ReadAll<ImuSample>(*log).size(), 20u);
  ASSERT_FALSE(log->health().damage.ranges.empty());
  EXPECT_EQ(log->health().damage.ranges[0].what,
            "oxts/timestamps.txt has 1 row that cannot be read: the file 0000000003.txt");
  fs::remove(folder.path() / "calib_imu_to_velo.txt");
  EXPECT_EQ(WhatOpeningThrows(folder.path()),
            "no rig: calib_imu_to_velo.txt is missing beside the drive");
  fs::remove_all(drive / "oxts");
  EXPECT_EQ(WhatOpeningThrows(folder.path()), "the log has no IMU data (oxts/timestamps.txt)");
}

/// What `numbers` are, parted by blanks.
template <typename Matrix>
std::string Words(const Matrix& numbers) {
  const Eigen::IOFormat row_by_row(Eigen::FullPrecision, Eigen::DontAlignCols, " ", " ");
  std::ostringstream text;
  text << numbers.format(row_by_row);
  return text.str();
}

/// KITTI's drive 13 as KITTI has it, of the copy in EuRoC's layout.
void WriteRealKittiFolder(const fs::path& clip, const fs::path& drive) {
  const auto stamp_of = [](Timestamp time) {
    const std::int64_t seconds = time.ns / 1'000'000'000 - 1'317'042'600;  // 13:10:00
    return "2011-09-26 13:" + Padded(static_cast<int>(10 + seconds / 60), 2) + ":" +
           Padded(static_cast<int>(seconds % 60), 2) + "." +
           Padded(static_cast<int>(time.ns % 1'000'000'000), 9) + "\n";
  };
  fs::create_directories(drive / "image_02" / "data");
  std::string stamps;
  int index = 0;
  EurocCsv images(clip / "mav0" / "cam0" / "data.csv");
  while (const auto line = images.Next()) {
    stamps += stamp_of(line->stamp);
    fs::create_symlink(clip / "mav0" / "cam0" / "data" / (std::to_string(line->stamp.ns) + ".jpg"),
                       drive / "image_02" / "data" / (Padded(index++, 10) + ".jpg"));
  }
  WriteText(drive / "image_02" / "timestamps.txt", stamps);
  stamps.clear();
  index = 0;
  EurocCsv samples(clip / "imu_oxts_measured_10hz.csv");
  while (const auto line = samples.Next()) {
    stamps += stamp_of(line->stamp);
    std::string rates, accelerations;
    const std::vector<std::string_view> numbers = SplitCsv(line->text);
    for (std::size_t i = 1; i <= 3; ++i) {
      rates.append(numbers[i]).append(" ");
      accelerations.append(numbers[i + 3]).append(" ");
    }
    WriteText(drive / "oxts" / "data" / (Padded(index, 10) + ".txt"),
              "49.0" + std::to_string(131418 + 10 * index) + " 8.437 114 0 0 0 0 0 12 0 0 " +
                  accelerations + "0 0 0 " + rates + "0 0 0 0.15 0.05 4 8 4 4 0\n");
    ++index;
  }
  WriteText(drive / "oxts" / "timestamps.txt", stamps);
  const Rig rig = ReadRig(clip / "rig");
  const Rigid3 camera_from_imu = rig.ImuFromCamera(0).Inverse();
  WriteText(drive / "calib_cam_to_cam.txt",
            "S_rect_02: 1242 375\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
            "P_rect_02: 721.5377 0 609.5593 0 0 721.5377 172.854 0 0 0 1 0\n");
  WriteText(drive / "calib_velo_to_cam.txt",
            "R: " + Words(camera_from_imu.rotation.toRotationMatrix()) +
                "\nT: " + Words(camera_from_imu.translation) + "\n");
  WriteText(drive / "calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
}

TEST(KittiFolder, ARealDriveComesOutWholeWithItsRig) {
  const fs::path clip = fs::absolute(SharedData() / "kitti_raw_0013");
  if (!fs::exists(clip)) GTEST_SKIP() << "PARKADE_SHARED_DATA has no kitti_raw_0013";
  const TestFolder folder;
  WriteRealKittiFolder(clip, folder.path() / "drive");

  const LogInspection inspection = InspectLog(folder.path());
  const auto log = OpenDriveLog(folder.path());

  EXPECT_EQ(inspection.ExitStatus(), 0) << InspectionToText(inspection);
  EXPECT_EQ(ReadAll<ImuSample>(*log).at(0).time.ns, 1'317'042'651'175'862'102);
  EXPECT_EQ(log->health().streams.at(0).num_delivered, 144u);
  // The first image was taken before the inertial unit's first sample.
  const StreamHealth camera = log->health().streams.at(3);
  EXPECT_EQ(camera.num_delivered, 143u);
  EXPECT_EQ(camera.Dropped(DropReason::kOffClock), 1u);
  const Rig expected = ReadRig(clip / "rig");
  EXPECT_TRUE(log->rig().ImuFromCamera(0).translation.isApprox(
      expected.ImuFromCamera(0).translation, 1e-6));
  EXPECT_TRUE(log->rig().body_from_imu.translation.isApprox(expected.body_from_imu.translation));
}

/// The same as WriteEurocFolder as tables and images that are called by their stamps [s], with the
/// rig that belongs to it.
void WritePlainFolder(const fs::path& drive, const fs::path& rig) {
  WriteEurocFolder(drive / "mav0", {.has_wheels = true, .has_gnss = true});
  fs::create_directories(rig);
  WriteRig(OpenDriveLog(drive)->rig(), rig);
  const auto move = [&](const char* from, const char* to) {
    fs::rename(drive / "mav0" / from / "data.csv", drive / to);
  };
  move("imu0", "imu.csv");
  move("odom0", "wheels.csv");
  move("gnss0", "gnss.csv");
  for (const char* camera : {"cam0", "cam1"}) {
    fs::create_directories(drive / camera);
    for (const auto& image : fs::directory_iterator(drive / "mav0" / camera / "data")) {
      std::string name = image.path().filename().string();
      fs::rename(image.path(), drive / camera / name.insert(name.size() - 13, "."));
    }
  }
  fs::remove_all(drive / "mav0");
}

TEST(PlainFolder, GivesTheSameAsEuroc) {
  const TestFolder folder;
  const fs::path drive = folder.path() / "drive", rig = folder.path() / "rig";
  WritePlainFolder(drive, rig);
  WriteArchive(folder.path() / "drive.zip", "zip", EntriesOf(drive, "drive/"));
  for (const fs::path& log_path : {drive, folder.path() / "drive.zip"}) {
    const auto log = OpenDriveLog(log_path, {.rig_folder = rig, .scratch_folder = folder.path()});

    EXPECT_EQ(ReadAll<ImuSample>(*log).size(), 201u);
    EXPECT_EQ(ReadAll<WheelSample>(*log)[100].forward_speed, 1.5);
    EXPECT_EQ(ReadAll<GnssFix>(*log)[1].sigma_enu, Eigen::Vector3d(0.5, 0.6, 1.5));
    const auto frames = ReadAll<CameraFrame>(*log);
    ASSERT_EQ(frames.size(), 42u);
    EXPECT_EQ(frames[1].time.ns, 1'000'007'000'000);
    EXPECT_EQ(frames[41].time.ns, 1'002'007'000'000);
    EXPECT_EQ(cv::norm(frames[41].image, NumberedImage(1, 20), cv::NORM_INF), 0);
    EXPECT_TRUE(log->health().damage.IsClean());
  }
}

TEST(PlainFolder, NeedsARigAndAnImu) {
  const TestFolder folder;
  const fs::path drive = folder.path() / "drive";
  WritePlainFolder(drive, folder.path() / "rig");

  EXPECT_EQ(WhatOpeningThrows(drive),
            "no rig: a folder of images and tables brings none, bring a rig of Kalibr's files");
  fs::remove(drive / "imu.csv");
  EXPECT_EQ(WhatOpeningThrows(drive), "the log has no IMU data (imu.csv)");
}

TEST(PlainFolder, ImagesBesideARecordingAreNoDrive) {
  const TestFolder folder;
  WriteText(folder.path() / "drive.mcap", "\x89MCAP0\r\n");
  WriteText(folder.path() / "cam0" / "1000.5.png", "an image");

  EXPECT_FALSE(FindDriveFolder(folder.path(), "folder").has_value());
  fs::remove(folder.path() / "drive.mcap");
  EXPECT_TRUE(FindDriveFolder(folder.path(), "folder").has_value());
}

/// A text with each match of a pattern replaced.
void EditAll(const fs::path& file, const char* pattern, const char* with) {
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  WriteText(file, std::regex_replace(text, std::regex(pattern), with));
}

TEST(EurocFolder, IsReadAsPeopleWriteIt) {
  const TestFolder folder;
  const fs::path mav0 = folder.path() / "mav0";
  WriteEurocFolder(mav0, {.begin_ns = 1'600'000'000'000'000'000, .has_wheels = true});
  EditAll(mav0 / "imu0" / "data.csv", "(\\d{10})(\\d{9}),", "$1.$2,");  // seconds
  EditAll(mav0 / "imu0" / "data.csv", ",", ";");
  EditAll(mav0 / "odom0" / "data.csv", "(\\d{16})000,", "$1,");  // microseconds
  EditAll(mav0 / "cam0" / "data.csv", ",(\\d+\\.png)", ",/home/me/cam0/data/$1");
  EditAll(mav0 / "cam1" / "data.csv", ",(\\d+\\.png)", ",data\\$1");

  const auto log = OpenDriveLog(folder.path());

  EXPECT_EQ(ReadAll<ImuSample>(*log)[7].time.ns, 1'600'000'000'070'000'000);
  EXPECT_EQ(ReadAll<ImuSample>(*log)[7].angular_velocity, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(ReadAll<WheelSample>(*log)[100].time.ns, 1'600'000'002'000'000'000);
  EXPECT_EQ(ReadAll<CameraFrame>(*log).size(), 42u);
  EXPECT_TRUE(log->health().damage.IsClean());
  std::vector<std::string> notes;
  for (const Finding& finding : log->health().findings)
    if (finding.name == "table_format") notes.push_back(finding.sentence);
  EXPECT_EQ(notes,
            (std::vector<std::string>{"imu0: as it seems, its stamps are in seconds",
                                      "odom0: as it seems, its stamps are in microseconds"}));
}

}  // namespace
}  // namespace parkade
