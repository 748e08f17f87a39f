#include "slam/refinement/wheel_slip.h"

#include "slam/smoother/drive_measurements.h"

namespace parkade {

std::vector<WheelSlip> SlipOfWheels(const DriveMeasurements& measurements, const Rig& rig,
                                    const Trajectory& odom_from_body, double wheel_scale) {
  std::vector<WheelSlip> slips;
  for (size_t j = 1; j < measurements.nodes.size(); ++j) {
    const std::optional<NodeInterval> interval = measurements.IntervalBefore(j);
    if (!interval || !interval->wheels || interval->is_still || interval->wheels->duration <= 0)
      continue;
    const Timestamp begin = measurements.nodes[j - 1].state.time,
                    end = measurements.nodes[j].state.time;
    const std::optional<Rigid3> before = odom_from_body.At(begin), after = odom_from_body.At(end);
    if (!before || !after) continue;
    const double driven =
        (before->rotation.conjugate() * (after->translation - before->translation)).x();
    const double rolled =
        wheel_scale * (rig.body_from_imu.rotation * interval->wheels->displacement).x();
    slips.push_back({end, (rolled - driven) / interval->wheels->duration});
  }
  return slips;
}

}  // namespace parkade
