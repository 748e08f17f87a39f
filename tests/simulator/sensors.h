#pragma once

// All sensors of the simulated car.
#include "tests/simulator/camera_clock.h"
#include "tests/simulator/drive_clock.h"
#include "tests/simulator/gnss_sensor.h"
#include "tests/simulator/imu_sensor.h"
#include "tests/simulator/sensor_options.h"
#include "tests/simulator/wheel_sensor.h"
