#include "server/ingest/checks/camera_checks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace parkade {
namespace {

constexpr double kMinSpeed = 0.4;       // [m/s] of the wheels
constexpr double kMinParallax = 0.012;  // [rad] that a point must move beside the rotation
constexpr double kMaxMiss = 0.035;      // [rad] of a point from its epipolar plane
constexpr int kMinPoints = 120;
constexpr double kAgrees = 0.6;  // share of a camera's points
constexpr double kContradicts = 0.35;

/// How a camera is taken to be, while it is judged.
struct Hypothesis {
  size_t camera = 0;  ///< of the rig, whose lens and place it has
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> pixel = nullptr;  ///< of the true image
  double rotation_sign = 1, speed_sign = 1;
};

/// Points of a camera that move as foretold, and all that were looked at.
struct Agreement {
  int num_agreeing = 0, num_points = 0;
  double share() const {
    return num_points == 0 ? 0 : static_cast<double>(num_agreeing) / num_points;
  }
};

}  // namespace

/// Judges the pairs of cameras by the gyroscope's rotations and the wheels' speeds.
class MotionJudge {
 public:
  MotionJudge(const CameraChecks& checks, const SpeedHistory& wheels)
      : checks_(checks), wheels_(wheels) {}

  Agreement Judge(size_t camera, const Hypothesis& hypothesis) const {
    Agreement agreement;
    size_t hint = 0, rate = 0;
    for (const ImagePair& pair : checks_.pairs_[camera].pairs()) {
      const std::optional<WheelSample> wheels = wheels_.Near(pair.first, hint);
      const std::optional<Eigen::Quaterniond> turn = Rotation(pair, rate);
      if (!wheels || !turn || std::abs(wheels->forward_speed) < kMinSpeed) continue;
      JudgePair(pair, *turn, wheels->forward_speed, hypothesis, agreement);
    }
    return agreement;
  }

 private:
  /// first_from_second of the IMU, by the trapezoids of its rates.
  std::optional<Eigen::Quaterniond> Rotation(const ImagePair& pair, size_t& hint) const {
    const auto& rates = checks_.gyroscope_;
    while (hint + 1 < rates.size() && rates[hint + 1].time <= pair.first) ++hint;
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    for (size_t i = hint; i + 1 < rates.size(); ++i) {
      const Timestamp begin = std::max(rates[i].time, pair.first),
                      end = std::min(rates[i + 1].time, pair.second);
      if (rates[i + 1].time - rates[i].time > 0.1) return std::nullopt;
      turn = turn * ExpSo3(0.5 * (rates[i].rate + rates[i + 1].rate) * (end - begin));
      if (rates[i + 1].time >= pair.second) return turn;
    }
    return std::nullopt;
  }

  void JudgePair(const ImagePair& pair, const Eigen::Quaterniond& turn_of_imu, double speed,
                 const Hypothesis& hypothesis, Agreement& agreement) const {
    const Rig& rig = checks_.rig_;
    const RigCamera& camera = rig.cameras[hypothesis.camera];
    const Eigen::Quaterniond turn = ExpSo3(hypothesis.rotation_sign * LogSo3(turn_of_imu));
    const Eigen::Quaterniond body_turn =
        rig.body_from_imu.rotation * turn * rig.body_from_imu.rotation.conjugate();
    const Eigen::Quaterniond& body_from_camera = camera.body_from_camera.rotation;
    // The rear axle follows the chord of its arc; the camera swings about it.
    const Eigen::Vector3d lever = camera.body_from_camera.translation;
    const Eigen::Vector3d moved =
        ExpSo3(0.5 * LogSo3(body_turn)) *
            Eigen::Vector3d(hypothesis.speed_sign * speed * (pair.second - pair.first), 0, 0) +
        body_turn * lever - lever;
    const Eigen::Vector3d way = (body_from_camera.conjugate() * moved).normalized();
    const Eigen::Quaterniond first_from_second =
        body_from_camera.conjugate() * body_turn * body_from_camera;
    const auto ray = [&](const Eigen::Vector2d& pixel) {
      return camera.model.Unproject(hypothesis.pixel ? hypothesis.pixel(pixel) : pixel);
    };
    for (size_t i = 0; i < pair.from.size(); ++i) {
      const auto before = ray(pair.from[i]), after = ray(pair.to[i]);
      if (!before || !after) continue;
      const Eigen::Vector3d now = first_from_second * after->normalized();
      const Eigen::Vector3d was = before->normalized();
      const double moved_by = std::acos(std::clamp(was.dot(now), -1.0, 1.0));
      if (moved_by < kMinParallax) continue;
      ++agreement.num_points;
      const Eigen::Vector3d plane = was.cross(way);
      const bool is_in_plane =
          plane.norm() > 0.1 && std::abs(plane.normalized().dot(now)) < kMaxMiss;
      const bool moves_away = now.dot(way) < was.dot(way);
      agreement.num_agreeing += is_in_plane && moves_away ? 1 : 0;
    }
  }

  const CameraChecks& checks_;
  const SpeedHistory& wheels_;
};

namespace {

/// What a camera may be that contradicts.
struct Explanation {
  std::string looks_like;
  Hypothesis hypothesis;
};

std::vector<Explanation> ExplanationsOf(const Rig& rig, size_t camera) {
  const CameraModel& own = rig.cameras[camera].model;
  const double right = own.width() - 1, bottom = own.height() - 1;
  std::vector<Explanation> explanations = {
      {"its images are upside down",
       {camera,
        [=](const Eigen::Vector2d& p) { return Eigen::Vector2d(right - p.x(), bottom - p.y()); }}},
      {"its images are mirrored",
       {camera, [=](const Eigen::Vector2d& p) { return Eigen::Vector2d(right - p.x(), p.y()); }}}};
  for (size_t other = 0; other < rig.cameras.size(); ++other) {
    const CameraModel& model = rig.cameras[other].model;
    if (other != camera && model.width() == own.width() && model.height() == own.height())
      explanations.push_back(
          {"its images are those of " + rig.cameras[other].name + ", topics have changed places",
           {.camera = other}});
  }
  return explanations;
}

/// Whether nothing moves in a camera's images.
bool IsFrozen(const ImagePairs& pairs) {
  constexpr double kStill = 0.1;  // [px]
  double num_still = 0, count = 0;
  for (const ImagePair& pair : pairs.pairs())
    for (size_t i = 0; i < pair.from.size(); ++i, ++count)
      num_still += (pair.to[i] - pair.from[i]).norm() < kStill ? 1 : 0;
  return count > 0 && num_still > 0.95 * count;
}

/// What was found about one camera.
struct Verdict {
  Agreement agreement;
  std::string looks_like;  ///< the best explanation; empty: none
  bool is_judged = false, is_wrong = false;
};

Verdict VerdictOn(const MotionJudge& judge, const Rig& rig, size_t camera,
                  const ImagePairs& pairs) {
  constexpr double kMuchBetter = 0.25;  // share of points, by which an explanation must win
  Verdict verdict;
  verdict.agreement = judge.Judge(camera, {.camera = camera});
  verdict.is_judged = verdict.agreement.num_points >= kMinPoints;
  if (!verdict.is_judged) return verdict;
  const double own = verdict.agreement.share();
  double best = std::max(kAgrees, own + kMuchBetter);
  verdict.is_wrong = own < kContradicts;
  if (IsFrozen(pairs)) {
    verdict.looks_like = "its image does not change";
    verdict.is_wrong = true;
    return verdict;
  }
  for (const Explanation& explanation : ExplanationsOf(rig, camera)) {
    const double share = judge.Judge(camera, explanation.hypothesis).share();
    if (share <= best) continue;
    best = share;
    verdict.looks_like = explanation.looks_like;
    verdict.is_wrong = true;
  }
  return verdict;
}

std::map<std::string, double> EvidenceOf(const Verdict& verdict) {
  return {{"agreeing_points", verdict.agreement.share()},
          {"points", static_cast<double>(verdict.agreement.num_points)}};
}

Finding LeftOut(const Verdict& verdict, const std::string& camera, const std::string& topic) {
  const std::string guess =
      verdict.looks_like.empty() ? "" : ": " + verdict.looks_like + ", as it seems";
  return {kCameraContradicts,
          Severity::kWarning,
          topic,
          "camera " + camera + " (" + topic +
              ") is left out: what it sees does not move as the car does" + guess,
          guess.empty() ? "check its topic, its lens and its place in the rig" : "",
          EvidenceOf(verdict)};
}

}  // namespace

CameraChecks::CameraChecks(const Rig& rig) : rig_(rig) {
  for (const RigCamera& camera : rig.cameras) pairs_.emplace_back(camera);
}

bool CameraChecks::WantsImage(int camera, Timestamp time) const {
  return rig_.vehicle && pairs_[static_cast<size_t>(camera)].Wants(time);
}

void CameraChecks::IncludeImage(int camera, Timestamp time, const cv::Mat& image) {
  pairs_[static_cast<size_t>(camera)].Include(time, image);
}

std::vector<Finding> CameraChecks::Findings(const SpeedHistory& wheels,
                                            const std::vector<std::string>& topics) const {
  if (!rig_.vehicle || topics.empty() || wheels.empty() || wheels.IsAlwaysZero()) return {};
  const MotionJudge judge(*this, wheels);
  std::vector<Verdict> verdicts;
  for (size_t camera = 0; camera < topics.size(); ++camera)
    verdicts.push_back(VerdictOn(judge, rig_, camera, pairs_[camera]));
  const auto count = [&](bool Verdict::*what) {
    return std::count_if(verdicts.begin(), verdicts.end(),
                         [&](const Verdict& verdict) { return verdict.*what; });
  };
  const bool are_all_wrong = count(&Verdict::is_wrong) == count(&Verdict::is_judged);
  // Speeds with the wrong sign make all cameras contradict, which the trajectory tells better.
  if (are_all_wrong && judge.Judge(0, {.camera = 0, .speed_sign = -1}).share() > kAgrees) return {};
  std::vector<Finding> findings;
  for (size_t camera = 0; camera < verdicts.size(); ++camera) {
    const Verdict& verdict = verdicts[camera];
    if (!verdict.is_wrong) continue;
    if (!are_all_wrong)
      findings.push_back(LeftOut(verdict, rig_.cameras[camera].name, topics[camera]));
    else if (!verdict.looks_like.empty() && findings.empty())
      findings.push_back({"cameras_contradict", Severity::kUnusable, "",
                          "what the cameras see does not move as IMU and wheels say: of " +
                              rig_.cameras[camera].name + " " + verdict.looks_like +
                              ", as it seems",
                          "", EvidenceOf(verdict)});
  }
  return findings;
}

}  // namespace parkade
