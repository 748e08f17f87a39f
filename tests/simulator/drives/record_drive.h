#pragma once

#include <string>
#include <vector>

#include "tests/simulator/drives/drive_summary.h"
#include "tests/simulator/drives/progress_listener.h"
#include "tests/simulator/render/renderer.h"
#include "tests/simulator/sinks/drive_sink.h"

namespace parkade::simulator {

/// Everything that is recorded without a camera.
struct SensorRecords {
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<GnssFix> gnss;
};

/// Samples of the sensors that `options` ask for.
SensorRecords SimulateSensors(const SimulateOptions& options, const Motion& motion, const Rig& rig,
                              const RoofQuery& is_covered);

struct RecordingTimes {
  double render = 0, encode = 0;  ///< [s] in all
};

struct Recording {
  DriveCounts counts;
  RecordingTimes times;
};

/// Takes all images of a drive and writes them to `sink`, with the other records, in order of time,
/// and with the faults that are asked for. `renderer` has the cameras of the true rig and, where a
/// mirror is knocked, the knocked one behind them.
Recording RecordDrive(const SimulateOptions& options, const Motion& motion, const Rig& rig,
                      const Renderer& renderer, const SensorRecords& records, DriveSink& sink,
                      const ProgressListener& progress);

}  // namespace parkade::simulator
