#include "tests/simulator/sensors/imu_grade.h"

#include <array>

#include "core/error.h"

namespace parkade::simulator {

const ImuGrade& ImuGradeNamed(const std::string& name) {
  static const std::array<ImuGrade, 2> grades = {{{.name = "rt3000",
                                                   .accelerometer_noise_density = 1.2e-4,
                                                   .accelerometer_random_walk = 1e-5,
                                                   .gyroscope_noise_density = 5.8e-5,
                                                   .gyroscope_random_walk = 8e-7,
                                                   .accelerometer_bias = 1e-3,
                                                   .gyroscope_bias = 1e-5,
                                                   .scale_error = 2e-4,
                                                   .misalignment = 1e-4},
                                                  {.name = "mems",
                                                   .accelerometer_noise_density = 2.5e-3,
                                                   .accelerometer_random_walk = 2e-4,
                                                   .gyroscope_noise_density = 2e-4,
                                                   .gyroscope_random_walk = 5e-6,
                                                   .accelerometer_bias = 0.06,
                                                   .gyroscope_bias = 0.004,
                                                   .scale_error = 1e-3,
                                                   .misalignment = 5e-4}}};
  for (const ImuGrade& grade : grades)
    if (grade.name == name) return grade;
  throw Error(ErrorCode::kUsage, "there is no IMU '" + name + "'; there are: rt3000, mems");
}

ImuCalibration CalibrationOf(const ImuGrade& grade, double rate, const std::string& topic) {
  return {.topic = topic,
          .update_rate = rate,
          .accelerometer_noise_density = grade.accelerometer_noise_density,
          .accelerometer_random_walk = grade.accelerometer_random_walk,
          .gyroscope_noise_density = grade.gyroscope_noise_density,
          .gyroscope_random_walk = grade.gyroscope_random_walk};
}

}  // namespace parkade::simulator
