#pragma once

// All sensors of the simulated car.
#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/sensors/gnss_sensor.h"
#include "tests/simulator/sensors/imu_sensor.h"
#include "tests/simulator/sensors/sensor_options.h"
#include "tests/simulator/sensors/wheel_sensor.h"
#include "tests/simulator/vehicle/camera_clock.h"
