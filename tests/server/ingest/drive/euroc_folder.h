#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace parkade {

/// A folder of its own for one test, gone with it.
class TestFolder {
 public:
  TestFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("parkade_") + test->test_suite_name() + "_" + test->name() + "_" +
             std::to_string(getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// Recordings of other people: PARKADE_SHARED_DATA or ../shared/data beside the repository.
inline std::filesystem::path SharedData() {
  const char* variable = std::getenv("PARKADE_SHARED_DATA");
  return variable ? variable : "../shared/data";
}

/// A small drive in EuRoC layout: `seconds` of IMU at 100 Hz and images of 64 x 48 at 10 Hz, each
/// of one gray value that tells its number (20 + 3 * index of the image, + 100 for cam1).
struct EurocFolderOptions {
  std::int64_t begin_ns = 1'000'000'000'000;
  double seconds = 2;
  int num_cameras = 2;
  bool has_wheels = false, has_gnss = false;
};

inline cv::Mat NumberedImage(int camera, int index) {
  return cv::Mat(48, 64, CV_8UC1, cv::Scalar((20 + 3 * index + 100 * camera) % 256));
}

inline std::string CameraSensorYaml(int camera) {
  return "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, 0, 1, 1.5, -1, "
         "0, 0, " +
         std::to_string(0.5 * camera) +
         ", 0, -1, 0, 0.8, 0, 0, 0, 1]\nrate_hz: 10\nresolution: [64, 48]\ncamera_model: pinhole\n"
         "intrinsics: [40, 40, 31.5, 23.5]\ndistortion_model: radial-tangential\n"
         "distortion_coefficients: [-0.1, 0.01, 0, 0]\n";
}

inline void WriteEurocFolder(const std::filesystem::path& mav0,
                             const EurocFolderOptions& options = {}) {
  std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n",
              wheels = "#timestamp [ns],v_x,w_z\n",
              gnss = "#timestamp [ns],lat,lon,alt,sigma_e,sigma_n,sigma_u\n";
  const int num_samples = static_cast<int>(options.seconds * 100);
  for (int i = 0; i <= num_samples; ++i) {
    const std::string stamp = std::to_string(options.begin_ns + i * 10'000'000LL);
    const std::string sway = std::to_string(i % 2);  // of a millimeter per second squared
    imu += stamp + ",0.01,0.02,0.03,0.100" + sway + ",0.200" + sway + "," +
           std::to_string(9.8 + i * 1e-3) + "\n";
    if (i % 2 == 0) wheels += stamp + ",1.5,0.25\n";
    if (i % 100 == 0) gnss += stamp + ",48.1,11.5,512.25,0.5,0.6,1.5\n";
  }
  WriteText(mav0 / "imu0" / "data.csv", imu);
  WriteText(mav0 / "imu0" / "sensor.yaml",
            "sensor_type: imu\nrate_hz: 100\ngyroscope_noise_density: 2.0e-4\n");
  if (options.has_wheels) WriteText(mav0 / "odom0" / "data.csv", wheels);
  if (options.has_gnss) WriteText(mav0 / "gnss0" / "data.csv", gnss);
  for (int camera = 0; camera < options.num_cameras; ++camera) {
    const std::filesystem::path folder = mav0 / ("cam" + std::to_string(camera));
    std::string index = "#timestamp [ns],filename\r\n";
    std::filesystem::create_directories(folder / "data");
    for (int i = 0; i <= num_samples / 10; ++i) {
      const std::string stamp =
          std::to_string(options.begin_ns + i * 100'000'000LL + camera * 7'000'000LL);
      index += stamp + "," + stamp + ".png\r\n";
      cv::imwrite((folder / "data" / (stamp + ".png")).string(), NumberedImage(camera, i));
    }
    WriteText(folder / "data.csv", index);
    WriteText(folder / "sensor.yaml", CameraSensorYaml(camera));
  }
}

}  // namespace parkade
