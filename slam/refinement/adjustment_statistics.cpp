#include "slam/refinement/adjustment_statistics.h"

#include "core/math/statistics.h"
#include "slam/factors/imu_cost.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/factors/wheel_cost.h"
#include "slam/refinement/adjusted_drive.h"
#include "slam/refinement/adjusted_landmarks.h"

namespace parkade {
namespace {

/// Sum of squares of a cost at its parameters, per residual.
double MeanSquare(const ceres::CostFunction& cost, const std::vector<double*>& blocks) {
  Eigen::VectorXd residual(cost.num_residuals());
  if (!cost.Evaluate(blocks.data(), residual.data(), nullptr)) return 0;
  return residual.squaredNorm() / static_cast<double>(residual.size());
}

}  // namespace

AdjustmentStatistics StatisticsOf(const AdjustedDrive& drive) {
  AdjustmentStatistics statistics;
  double imu = 0;
  std::vector<double> wheels, bearings, loops, unused_loops;
  for (size_t j = 1; j < drive.nodes.size(); ++j) {
    const AdjustedNode &i = drive.nodes[j - 1], &node = drive.nodes[j];
    if (!node.interval) continue;
    imu += MeanSquare(ImuCost(&node.interval->imu), {i.pose, i.motion, node.pose, node.motion});
    if (node.interval->wheels && !node.interval->is_still)
      wheels.push_back(MeanSquare(WheelCost(*node.interval->wheels),
                                  {i.pose, i.motion, node.pose, drive.wheel_scale}));
  }
  if (drive.nodes.size() > 1) statistics.imu = imu / static_cast<double>(drive.nodes.size() - 1);
  double unused_bearings = 0;
  size_t num_unused = 0;
  for (const AdjustedLandmark& landmark : drive.landmarks) {
    if (!landmark.is_used) {
      unused_bearings += RobustErrorOf(drive, landmark);
      num_unused += landmark.observations.size();
      continue;
    }
    statistics.num_landmarks += !landmark.observations.empty();
    for (const AdjustedObservation& observation : landmark.observations) {
      std::vector<double*> blocks = drive.images[observation.image].geometry.Blocks();
      blocks.push_back(landmark.values);
      bearings.push_back(MeanSquare(*observation.cost, blocks));
    }
  }
  if (num_unused > 0)
    statistics.unused_bearings = unused_bearings / static_cast<double>(num_unused);
  for (const AdjustedLoop& loop : drive.loops)
    (loop.is_used ? loops : unused_loops)
        .push_back(MeanSquare(RelativePoseCost(loop.from_from_to, loop.square_root_weight),
                              {drive.nodes[loop.from].pose, drive.nodes[loop.to].pose}));
  std::vector<double> gnss;
  for (const AdjustedFix& fix : drive.fixes)
    gnss.push_back(MeanSquare(
        GnssCost(fix.antenna),
        {drive.nodes[fix.first].pose, drive.nodes[fix.first + 1].pose, drive.site_from_odom}));
  statistics.gnss = Median(gnss);
  statistics.num_bearings = bearings.size();
  statistics.wheels = Median(wheels);
  statistics.bearings = Median(bearings);
  statistics.loops = Median(loops);
  statistics.unused_loops = Median(unused_loops);
  return statistics;
}

}  // namespace parkade
