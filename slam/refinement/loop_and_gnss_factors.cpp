#include "slam/refinement/loop_and_gnss_factors.h"

#include <algorithm>
#include <cmath>

#include "core/math/decompositions.h"
#include "slam/pose_graph/pose_graph.h"

namespace parkade {
namespace {

constexpr double kMinFixSigma = 0.01;  // [m] receivers that claim less are not believed

size_t NearestNode(const DriveMeasurements& measurements, Timestamp time) {
  const auto& nodes = measurements.nodes;
  const auto after =
      std::lower_bound(nodes.begin(), nodes.end(), time,
                       [](const RecordedNode& node, Timestamp t) { return node.state.time < t; });
  if (after == nodes.end()) return nodes.size() - 1;
  if (after == nodes.begin() || after->state.time - time < time - (after - 1)->state.time)
    return static_cast<size_t>(after - nodes.begin());
  return static_cast<size_t>(after - nodes.begin()) - 1;
}

Matrix6d AdjointOf(const Rigid3& motion) {
  const Eigen::Matrix3d rotation = motion.rotation.toRotationMatrix();
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = rotation;
  adjoint.topRightCorner<3, 3>() = Skew(motion.translation) * rotation;
  return adjoint;
}

/// A loop between frames that are rigid with two nodes, as one between the nodes.
class LoopTranslator {
 public:
  LoopTranslator(const DriveMeasurements& measurements, const Trajectory& odometry)
      : measurements_(measurements), odometry_(odometry) {}

  std::optional<AdjustedLoop> Translate(const LoopEvidence& loop) const {
    AdjustedLoop adjusted;
    adjusted.from = NearestNode(measurements_, loop.earlier);
    adjusted.to = NearestNode(measurements_, loop.later);
    const std::optional<Rigid3> first = NodeFromPlace(adjusted.from, loop.earlier);
    const std::optional<Rigid3> second = NodeFromPlace(adjusted.to, loop.later);
    if (adjusted.from == adjusted.to || !first || !second) return std::nullopt;
    const Rigid3 later_node_from_end = *second * loop.later_from_camera;
    adjusted.from_from_to = *first * loop.pose.a_from_b * second->Inverse();
    adjusted.square_root_weight =
        SquareRootOf(loop.share * loop.pose.information) * AdjointOf(later_node_from_end.Inverse());
    return adjusted;
  }

 private:
  std::optional<Rigid3> NodeFromPlace(size_t node, Timestamp time) const {
    const std::optional<Rigid3> body = odometry_.At(time);
    if (!body) return std::nullopt;
    return measurements_.nodes[node].state.odom_from_imu.Inverse() * LeveledPose(*body);
  }

  const DriveMeasurements& measurements_;
  const Trajectory& odometry_;
};

}  // namespace

std::vector<AdjustedLoop> LoopsBetweenNodes(const DriveMeasurements& measurements,
                                            const Trajectory& odometry,
                                            const LoopClosure& closure) {
  const LoopTranslator translator(measurements, odometry);
  std::vector<AdjustedLoop> loops;
  for (const LoopEvidence& evidence : closure.loops) {
    if (evidence.weight <= 0.5) continue;
    if (std::optional<AdjustedLoop> loop = translator.Translate(evidence)) loops.push_back(*loop);
  }
  return loops;
}

PlacedFixes FixesBetweenNodes(const DriveMeasurements& measurements, const Rig& rig,
                              const Trajectory& odom_from_body, const GnssPositions& gnss) {
  const std::optional<GnssAlignment> alignment =
      AlignToGnss(odom_from_body, gnss.fixes, gnss.antenna_in_body, gnss.options);
  if (!alignment) return {};
  std::vector<GnssFix> usable;
  std::copy_if(gnss.fixes.begin(), gnss.fixes.end(), std::back_inserter(usable),
               [&](const GnssFix& fix) {
                 return IsUsable(fix, odom_from_body, gnss.options.max_fix_sigma);
               });
  // Errors of fixes in quick succession are one error.
  const double interval =
      (usable.back().time - usable.front().time) / static_cast<double>(usable.size());
  const double inflation =
      std::sqrt(std::max(1.0, gnss.options.correlation_time / std::max(interval, 1e-3)));
  const auto& nodes = measurements.nodes;
  PlacedFixes placed{{}, alignment->site_from_odom};
  for (const GnssFix& fix : usable) {
    const auto after =
        std::upper_bound(nodes.begin(), nodes.end(), fix.time,
                         [](Timestamp t, const RecordedNode& node) { return t < node.state.time; });
    if (after == nodes.begin() || after == nodes.end()) continue;
    AdjustedFix& adjusted = placed.fixes.emplace_back();
    adjusted.first = static_cast<size_t>(after - nodes.begin()) - 1;
    const Timestamp before = nodes[adjusted.first].state.time;
    adjusted.antenna.fraction = (fix.time - before) / (after->state.time - before);
    adjusted.antenna.antenna_in_imu = rig.body_from_imu.Inverse() * gnss.antenna_in_body;
    adjusted.antenna.antenna_in_site =
        SiteFromGeodetic(alignment->datum, fix.latitude_deg, fix.longitude_deg, fix.altitude);
    adjusted.antenna.sigma = inflation * fix.sigma_enu.cwiseMax(kMinFixSigma);
  }
  return placed;
}

}  // namespace parkade
