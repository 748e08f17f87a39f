#include "tests/simulator/sensors/sensor_options.h"

#include <cmath>

#include "core/error.h"
#include "tests/simulator/sensors/imu_grade.h"

namespace parkade::simulator {

void SensorOptions::Validate() const {
  ImuGradeNamed(imu);
  Require(imu_rate >= 10 && imu_rate <= 1000, ErrorCode::kUsage,
          "the IMU's rate must be 10 to 1000 Hz");
  Require(gnss == "standard" || gnss == "rtk" || gnss == "none", ErrorCode::kUsage,
          "GNSS is 'standard', 'rtk' or 'none', not '" + gnss + "'");
  Require(imu_noise >= 0 && wheel_noise >= 0 && gnss_sigma >= 0, ErrorCode::kUsage,
          "noises must not be negative");
  Require(gnss_memory > 0, ErrorCode::kUsage, "the memory of GNSS errors must be > 0 s");
  Require(wheel_slips >= 0 && wheel_slips <= 60 && gnss_multipath >= 0 && gnss_multipath <= 60,
          ErrorCode::kUsage, "slips and multipath jumps must be 0 to 60 per minute");
  Require(std::abs(wheel_scale_error) < 0.5, ErrorCode::kUsage,
          "the wheels' scale error must be less than 0.5");
}

}  // namespace parkade::simulator
