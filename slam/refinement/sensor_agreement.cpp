#include "slam/refinement/sensor_agreement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "slam/factors/sample_buffer.h"
#include "slam/places/adjust_two_views.h"
#include "slam/smoother/drive_measurements.h"

namespace parkade {
namespace {

constexpr double kStretch = 1;               // [s]
constexpr size_t kMaxStretches = 60;         // of those with the largest turns
constexpr double kMinTime = 0.3;             // [s] between two images
constexpr size_t kMinShared = 15;            // points
constexpr double kMinWay = 0.3;              // [m] between two images that tell a direction
constexpr double kTurnFloor = 5e-4;          // [rad] what no pair is more exact than
constexpr double kDirectionFloor = 5e-3;     // [rad]
constexpr double kMaxDirectionSigma = 0.05;  // [rad]
constexpr double kLeastNoise = 0.1;          // of what the tracker declares
constexpr size_t kMinRows = 5;
const double kOverlap = std::sqrt(2.0);  // of sigmas: each moment lies in two stretches

/// One equation design . unknowns = error, of known sigma.
template <int N>
struct Row {
  Eigen::Matrix<double, N, 1> design;
  double error = 0, sigma = 1;
};

template <int N>
struct Solution {
  Eigen::Matrix<double, N, 1> value = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, 1> sigma = Eigen::Matrix<double, N, 1>::Ones();
};

/// Least squares with Huber's weights; sigmas grow with the scatter.
template <int N>
Solution<N> Solve(const std::vector<Row<N>>& rows, const Eigen::Matrix<double, N, 1>& prior_sigma) {
  constexpr double kClip = 2;
  Solution<N> solution;
  Eigen::Matrix<double, N, N> covariance;
  double squared = 0;
  for (int step = 0; step < 8; ++step) {
    Eigen::Matrix<double, N, N> information = prior_sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    Eigen::Matrix<double, N, 1> pull = Eigen::Matrix<double, N, 1>::Zero();
    squared = 0;
    for (const Row<N>& row : rows) {
      const double off = std::abs(row.error - row.design.dot(solution.value)) / row.sigma;
      const double weight = std::min(1.0, kClip / std::max(off, 1e-9));
      information += weight / (row.sigma * row.sigma) * row.design * row.design.transpose();
      pull += weight / (row.sigma * row.sigma) * row.error * row.design;
      squared += weight * off * off;
    }
    covariance = information.inverse();
    solution.value = covariance * pull;
  }
  const double scatter = std::max(1.0, squared / static_cast<double>(rows.size()));
  solution.sigma = (scatter * covariance.diagonal()).cwiseSqrt();
  return solution;
}

/// The lead by all rows but one: the one without which they say the least. A place that is off
/// shows in every turn, a mismatch in one pair.
Solution<2> SolveWithoutOne(const std::vector<Row<2>>& rows) {
  const Eigen::Vector2d prior_sigma(2, 0.05);  // [m], [rad]
  const auto sureness = [](const Solution<2>& s) { return std::abs(s.value[0]) / s.sigma[0]; };
  Solution<2> least = Solve<2>(rows, prior_sigma);
  for (size_t i = 0; i < rows.size(); ++i) {
    std::vector<Row<2>> others = rows;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Solution<2> without = Solve<2>(others, prior_sigma);
    if (sureness(without) < sureness(least)) least = without;
  }
  return least;
}

/// Two images of a camera, and what their points say.
struct Pair {
  size_t camera = 0;
  Timestamp first, second;
  Rigid3 first_from_second;  ///< of the camera; of the way its direction alone
  AdjustedTwoViews known;
};

class Comparison {
 public:
  explicit Comparison(const OdometryResult& odometry)
      : odometry_(odometry),
        measurements_(*odometry.measurements),
        rig_(odometry.rig),
        of_camera_(rig_.cameras.size()) {}

  void AddStretch(Timestamp begin) {
    const Timestamp end = begin + kStretch;
    std::vector<std::vector<RecordedImage>> images(rig_.cameras.size());
    for (size_t i = FirstImageAt(begin); i < measurements_.num_images(); ++i) {
      RecordedImage image = measurements_.Image(i);
      if (image.time > end + kStretch) break;
      const auto camera = static_cast<size_t>(image.camera);
      image.time =
          image.time + (measurements_.shared.cameras[camera].time_offset() - image.time_offset);
      if (image.time >= begin && image.time <= end) images[camera].push_back(std::move(image));
    }
    std::optional<ImuBuffer> samples;
    for (const std::vector<RecordedImage>& of_camera : images)
      if (const std::optional<Pair> pair = LongestPair(of_camera)) {
        if (!samples) samples = SamplesBetween(begin, end);
        Compare(*pair, *samples);
      }
  }

  SensorAgreement Result() const {
    SensorAgreement agreement;
    agreement.num_pairs = static_cast<int>(turns_.size());
    if (turns_.size() >= kMinRows) {
      const Solution<3> turns = Solve<3>(turns_, {1, 0.1, 0.003});
      agreement.turn_gain = turns.value[0];
      agreement.turn_gain_sigma = kOverlap * turns.sigma[0];
      agreement.turn_delay = turns.value[1];
      agreement.turn_delay_sigma = kOverlap * turns.sigma[1];
    }
    for (size_t camera = 0; camera < of_camera_.size(); ++camera) {
      if (of_camera_[camera].size() < kMinRows) continue;
      const Solution<2> lead = SolveWithoutOne(of_camera_[camera]);
      agreement.leads.push_back(
          {rig_.cameras[camera].name, lead.value[0], kOverlap * lead.sigma[0]});
    }
    return agreement;
  }

 private:
  size_t FirstImageAt(Timestamp begin) const {
    size_t low = 0, high = measurements_.num_images();
    while (low < high) {
      const size_t middle = (low + high) / 2;
      if (measurements_.Image(middle).time < begin - kStretch)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }

  /// All samples of the nodes that a stretch meets, without the biases found.
  ImuBuffer SamplesBetween(Timestamp begin, Timestamp end) const {
    const std::vector<RecordedNode>& nodes = measurements_.nodes;
    auto node = std::partition_point(nodes.begin(), nodes.end(),
                                     [&](const RecordedNode& n) { return n.state.time <= begin; });
    ImuBuffer samples;
    for (; node != nodes.end(); ++node) {
      const auto interval = measurements_.IntervalBefore(static_cast<size_t>(node - nodes.begin()));
      if (!interval) continue;
      for (ImuSample sample : interval->imu.samples()) {
        sample.angular_velocity -= node->state.gyroscope_bias;
        samples.Add(sample);
      }
      if (node->state.time >= end) break;
    }
    return samples;
  }

  std::optional<Rigid3> OdomFromCamera(size_t camera, Timestamp time) const {
    const std::optional<Rigid3> body = odometry_.odom_from_body.At(time);
    if (!body) return std::nullopt;
    return *body * rig_.cameras[camera].body_from_camera;
  }

  /// From the first image to the last that has enough of its points.
  std::optional<Pair> LongestPair(const std::vector<RecordedImage>& images) const {
    if (images.size() < 2) return std::nullopt;
    const RecordedImage& first = images.front();
    const double noise = std::max(
        kLeastNoise, measurements_.shared.camera_noise_scales[static_cast<size_t>(first.camera)]);
    std::unordered_map<std::int64_t, const RecordedObservation*> seen;
    for (const RecordedObservation& observation : first.observations)
      seen[observation.track] = &observation;
    for (size_t i = images.size() - 1; i > 0 && images[i].time - first.time >= kMinTime; --i) {
      std::vector<RayPair> rays;
      for (const RecordedObservation& now : images[i].observations)
        if (const auto was = seen.find(now.track); was != seen.end())
          rays.push_back({was->second->bearing.cast<double>(), now.bearing.cast<double>(),
                          noise * was->second->sigma, noise * now.sigma});
      if (rays.size() < kMinShared) continue;
      Pair pair;
      pair.camera = static_cast<size_t>(first.camera);
      pair.first = first.time;
      pair.second = images[i].time;
      const auto odom_from_first = OdomFromCamera(pair.camera, pair.first),
                 odom_from_second = OdomFromCamera(pair.camera, pair.second);
      if (!odom_from_first || !odom_from_second) return std::nullopt;
      pair.first_from_second = odom_from_first->Inverse() * *odom_from_second;
      if (pair.first_from_second.translation.norm() < kMinWay) return std::nullopt;
      pair.first_from_second.translation.normalize();
      pair.known = AdjustTwoViews(rays, pair.first_from_second);
      return pair;
    }
    return std::nullopt;
  }

  void Compare(const Pair& pair, const ImuBuffer& samples) {
    if (samples.empty() || samples.front().time > pair.first || samples.back().time < pair.second)
      return;
    CompareTurns(pair, samples);
    CompareWays(pair);
  }

  void CompareTurns(const Pair& pair, const ImuBuffer& samples) {
    const Eigen::Quaterniond imu_from_camera = rig_.ImuFromCamera(pair.camera).rotation;
    const Eigen::Quaterniond by_images =
        imu_from_camera * pair.first_from_second.rotation * imu_from_camera.conjugate();
    const MotionIncrement read = Integrate(samples.Between(pair.first, pair.second), {});
    const Eigen::Vector3d up = rig_.body_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d change =
        samples.At(pair.second).angular_velocity - samples.At(pair.first).angular_velocity;
    const Eigen::Vector3d up_in_camera = imu_from_camera.conjugate() * up;
    Row<3> row;
    row.design << -up.dot(LogSo3(read.rotation)), up.dot(change), -read.duration;
    row.error = up.dot(LogSo3(read.rotation.conjugate() * by_images));
    row.sigma = std::hypot(
        std::sqrt(up_in_camera.dot(pair.known.rotation_covariance * up_in_camera)), kTurnFloor);
    turns_.push_back(row);
  }

  void CompareWays(const Pair& pair) {
    if (pair.known.direction_sigma > kMaxDirectionSigma) return;
    const Rigid3 odom_from_first = *OdomFromCamera(pair.camera, pair.first),
                 odom_from_second = *OdomFromCamera(pair.camera, pair.second);
    const Eigen::Quaterniond& body_from_camera =
        rig_.cameras[pair.camera].body_from_camera.rotation;
    const Rigid3 by_path = odom_from_first.Inverse() * odom_from_second;
    const Eigen::Vector3d way = body_from_camera * by_path.translation;
    const Eigen::Vector3d seen = body_from_camera * pair.first_from_second.translation;
    const Eigen::Quaterniond turn =
        body_from_camera * by_path.rotation * body_from_camera.conjugate();
    const Eigen::Vector3d by_lead = turn * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitX();
    const double flat = way.head<2>().squaredNorm();
    if (flat < kMinWay * kMinWay) return;
    Row<2> row;
    row.design << way.cross(by_lead).z() / flat, 1;
    row.error = std::atan2(way.cross(seen).z(), way.head<2>().dot(seen.head<2>()));
    row.sigma = std::hypot(pair.known.direction_sigma, kDirectionFloor);
    if (std::abs(row.error) < 1) of_camera_[pair.camera].push_back(row);
  }

  const OdometryResult& odometry_;
  const DriveMeasurements& measurements_;
  const Rig& rig_;
  std::vector<Row<3>> turns_;                   ///< gain, delay, bias
  std::vector<std::vector<Row<2>>> of_camera_;  ///< lead, angle of the mount
};

/// A car's rear axle goes where it points, and a point ahead of it sideways in turns, too.
Solution<2> FitBodyLead(const Trajectory& odom_from_body) {
  constexpr double kStep = 0.5, kSide = 0.15;     // [s] from one row to the next; of a turn
  constexpr double kSlowest = 0.5, kFastest = 8;  // [m/s] at which tires hardly slip sideways
  constexpr double kSwayingSpeed = 0.03;          // [m/s] of a body on its springs
  std::vector<Row<2>> rows;
  const TimeSpan span = odom_from_body.span();
  for (Timestamp time = span.begin + kSide; time + kSide <= span.end; time = time + kStep) {
    const auto before = odom_from_body.At(time - kSide), now = odom_from_body.At(time),
               after = odom_from_body.At(time + kSide);
    if (!before || !now || !after) continue;
    const Eigen::Vector3d velocity =
        now->rotation.conjugate() * (after->translation - before->translation) / (2 * kSide);
    if (std::abs(velocity.x()) < kSlowest || std::abs(velocity.x()) > kFastest) continue;
    const double yaw_rate =
        LogSo3(before->rotation.conjugate() * after->rotation).z() / (2 * kSide);
    rows.push_back({{yaw_rate, velocity.x()}, velocity.y(), kSwayingSpeed});
  }
  if (rows.size() < kMinRows) return {.value = Eigen::Vector2d::Zero(), .sigma = {1e3, 1e3}};
  return Solve<2>(rows, {10, 0.05});
}

/// The stretches of the drive in which the car turns most. They overlap by half (kOverlap).
std::vector<Timestamp> StretchesWithTurns(const Trajectory& odom_from_body) {
  struct Stretch {
    Timestamp begin;
    double turn;
  };
  std::vector<Stretch> stretches;
  const TimeSpan span = odom_from_body.span();
  for (Timestamp begin = span.begin; begin + kStretch <= span.end; begin = begin + kStretch / 2) {
    const auto first = odom_from_body.At(begin), last = odom_from_body.At(begin + kStretch);
    if (first && last)
      stretches.push_back({begin, first->rotation.angularDistance(last->rotation)});
  }
  std::stable_sort(stretches.begin(), stretches.end(),
                   [](const Stretch& a, const Stretch& b) { return a.turn > b.turn; });
  std::vector<Timestamp> begins;
  for (size_t i = 0; i < std::min(stretches.size(), kMaxStretches); ++i)
    begins.push_back(stretches[i].begin);
  return begins;
}

}  // namespace

SensorAgreement MeasureSensorAgreement(const OdometryResult& odometry) {
  if (!odometry.measurements || !odometry.rig.vehicle || odometry.odom_from_body.empty()) return {};
  Comparison comparison(odometry);
  for (const Timestamp begin : StretchesWithTurns(odometry.odom_from_body))
    comparison.AddStretch(begin);
  SensorAgreement agreement = comparison.Result();
  const Solution<2> body = FitBodyLead(odometry.odom_from_body);
  agreement.body_lead = body.value[0];
  agreement.body_lead_sigma = body.sigma[0];
  return agreement;
}

}  // namespace parkade
