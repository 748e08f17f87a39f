#include "server/ingest/checks/camera_checks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "server/ingest/checks/camera_speeds.h"
#include "server/ingest/checks/gyroscope_findings.h"
#include "server/ingest/checks/pair_motion.h"

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
  bool skips_still = true;  ///< pairs of an image that is repeated
};

}  // namespace

/// Judges the pairs of cameras by the gyroscope's rotations and the wheels' speeds.
class MotionJudge {
 public:
  MotionJudge(const CameraChecks& checks, const GyroscopeHistory& gyroscope,
              const SpeedHistory& wheels)
      : checks_(checks), gyroscope_(gyroscope), wheels_(wheels) {}

  PointAgreement Judge(size_t camera, const Hypothesis& hypothesis) const {
    PointAgreement agreement;
    size_t hint = 0, rate = 0;
    for (const ImagePair& pair : checks_.pairs_[camera].pairs()) {
      const std::optional<WheelSample> wheels = wheels_.Near(pair.first, hint);
      const std::optional<Eigen::Quaterniond> turn =
          gyroscope_.Rotation(pair.first, pair.second, rate);
      if (!wheels || !turn || std::abs(wheels->forward_speed) < kMinSpeed) continue;
      if (hypothesis.skips_still && pair.IsStill()) continue;
      JudgePair(pair, *turn, wheels->forward_speed, hypothesis, agreement);
    }
    return agreement;
  }

 private:
  void JudgePair(const ImagePair& pair, const Eigen::Quaterniond& turn_of_imu, double speed,
                 const Hypothesis& hypothesis, PointAgreement& agreement) const {
    const Rig& rig = checks_.rig_;
    const RigCamera& camera = rig.cameras[hypothesis.camera];
    const Eigen::Quaterniond turn = ExpSo3(hypothesis.rotation_sign * LogSo3(turn_of_imu));
    const Eigen::Quaterniond body_turn =
        rig.body_from_imu.rotation * turn * rig.body_from_imu.rotation.conjugate();
    const Eigen::Quaterniond& body_from_camera = camera.body_from_camera.rotation;
    const Eigen::Vector3d way =
        WayOfCamera(camera, body_turn, hypothesis.speed_sign * speed * (pair.second - pair.first));
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
  const GyroscopeHistory& gyroscope_;
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
  for (const double size : {2.0, 4.0})
    explanations.push_back(
        {"its lens is calibrated for images " + FormatText("%g", size) + " times as large",
         {camera, [=](const Eigen::Vector2d& p) { return Eigen::Vector2d(size * p); }}});
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
  return !pairs.pairs().empty() &&
         std::all_of(pairs.pairs().begin(), pairs.pairs().end(),
                     [](const ImagePair& pair) { return pair.IsStill(); });
}

/// Whether hardly any corner of an image is found again in the next.
bool ShowsNoise(const ImagePairs& pairs) {
  constexpr std::size_t kManyCorners = 200;
  std::size_t num_corners = 0, num_found = 0;
  for (const ImagePair& pair : pairs.pairs()) {
    num_corners += pair.num_corners;
    num_found += pair.from.size();
  }
  return num_corners >= kManyCorners && 4 * num_found < num_corners;
}

CameraVerdict VerdictOn(const MotionJudge& judge, const Rig& rig, size_t camera,
                        const ImagePairs& pairs) {
  constexpr double kMuchBetter = 0.25;  // share of points, by which an explanation must win
  CameraVerdict verdict;
  if (ShowsNoise(pairs)) {
    verdict.is_noise = true;
    verdict.looks_like = "nothing of an image is found again in the next";
    return verdict;
  }
  const bool is_frozen = IsFrozen(pairs);
  verdict.agreement = judge.Judge(camera, {.camera = camera, .skips_still = !is_frozen});
  verdict.is_judged = verdict.agreement.num_points >= kMinPoints;
  if (!verdict.is_judged) return verdict;
  const double own = verdict.agreement.share();
  double best = std::max(kAgrees, own + kMuchBetter);
  verdict.is_wrong = own < kContradicts;
  if (is_frozen) {
    verdict.looks_like = "its image does not change";
    verdict.is_wrong = true;
    return verdict;
  }
  if (best >= 1) return verdict;  // no other can be that much better
  for (const Explanation& explanation : ExplanationsOf(rig, camera)) {
    const PointAgreement agreement = judge.Judge(camera, explanation.hypothesis);
    // Points that no longer move agree with anything.
    if (agreement.share() <= best || 2 * agreement.num_points < verdict.agreement.num_points)
      continue;
    best = agreement.share();
    verdict.looks_like = explanation.looks_like;
    verdict.is_wrong = true;
  }
  return verdict;
}

/// Whether every camera moves as the car would if the wheels' speed had the other sign.
bool FitReversed(const MotionJudge& judge, const std::vector<CameraVerdict>& verdicts) {
  for (size_t camera = 0; camera < verdicts.size(); ++camera)
    if (verdicts[camera].is_judged &&
        judge.Judge(camera, {.camera = camera, .speed_sign = -1}).share() <= kAgrees)
      return false;
  return true;
}

std::map<std::string, double> EvidenceOf(const CameraVerdict& verdict) {
  return {{"agreeing_points", verdict.agreement.share()},
          {"points", static_cast<double>(verdict.agreement.num_points)}};
}

Finding LeftOut(const CameraVerdict& verdict, const std::string& camera, const std::string& topic) {
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

void CameraChecks::IncludeImage(int camera, Timestamp time, UndecodedImage image) {
  constexpr size_t kMaxWaitingBytes = size_t{32} << 20;
  pairs_[static_cast<size_t>(camera)].Include(time, std::move(image));
  size_t num_bytes = 0;
  for (const ImagePairs& pairs : pairs_) num_bytes += pairs.num_waiting_bytes();
  if (num_bytes > kMaxWaitingBytes) FollowPairs();
}

void CameraChecks::FollowPairs() {
  ParallelFor(pairs_.size(), [&](size_t camera) { pairs_[camera].Follow(); });
}

SpeedHistory CameraChecks::Speeds() const {
  return rig_.vehicle ? SpeedsByCameras(rig_, pairs_) : SpeedHistory();
}

int CameraChecks::NumMovingAtRest(const SpeedHistory& wheels) const {
  constexpr double kMoving = 0.005;                     // of the image's width, that points move
  constexpr double kMoment = 0.3;                       // [s]
  std::map<std::int64_t, std::pair<int, int>> moments;  // cameras that move, all
  for (size_t camera = 0; camera < pairs_.size(); ++camera) {
    size_t first_hint = 0, second_hint = 0;
    for (const ImagePair& pair : pairs_[camera].pairs()) {
      const auto first = wheels.Near(pair.first, first_hint),
                 second = wheels.Near(pair.second, second_hint);
      if (!first || !second || first->forward_speed != 0 || second->forward_speed != 0) continue;
      const double since = pair.first - wheels.samples().front().time;
      auto& [num_moving, num_cameras] = moments[static_cast<std::int64_t>(since / kMoment)];
      ++num_cameras;
      num_moving += pair.MedianMotion() > kMoving * rig_.cameras[camera].model.width() ? 1 : 0;
    }
  }
  return static_cast<int>(std::count_if(moments.begin(), moments.end(), [](const auto& moment) {
    return 2 * moment.second.first > moment.second.second;
  }));
}

std::vector<Finding> CameraChecks::CheckNoise(const std::vector<std::string>& topics) const {
  constexpr double kMuch = 16;  // [gray levels]; cameras at night have 4 to 8
  std::vector<Finding> findings;
  for (size_t camera = 0; camera < topics.size(); ++camera) {
    const double noise = pairs_[camera].Noise();
    if (noise < kMuch) continue;
    findings.push_back({"images_noisy",
                        Severity::kWarning,
                        topics[camera],
                        "the images of camera " + rig_.cameras[camera].name +
                            FormatText(" have noise of %.0f gray levels", noise) +
                            ", in which points cannot be followed exactly",
                        "use a longer exposure, or a higher quality where images are compressed",
                        {{"noise_gray_levels", noise}}});
  }
  return findings;
}

CameraChecks::Verdicts CameraChecks::VerdictsBy(const GyroscopeHistory& gyroscope,
                                                const SpeedHistory& wheels) const {
  const MotionJudge judge(*this, gyroscope, wheels);
  Verdicts verdicts;
  verdicts.cameras.reserve(pairs_.size());
  verdicts.right.reserve(pairs_.size());
  for (size_t camera = 0; camera < pairs_.size(); ++camera) {
    verdicts.cameras.push_back(VerdictOn(judge, rig_, camera, pairs_[camera]));
    const CameraVerdict& verdict = verdicts.cameras.back();
    verdicts.right.push_back(verdict.is_wrong || verdict.is_noise ? nullptr : &pairs_[camera]);
    verdicts.num_wrong += verdict.is_wrong ? 1 : 0;
    verdicts.num_judged += verdict.is_judged ? 1 : 0;
  }
  verdicts.fit_reversed_wheels = verdicts.AreAllWrong() && FitReversed(judge, verdicts.cameras);
  return verdicts;
}

std::vector<Finding> CameraChecks::Findings(const SpeedHistory& wheels,
                                            const std::vector<std::string>& topics,
                                            const std::string& imu_topic) const {
  if (!rig_.vehicle || topics.empty() || wheels.empty() || wheels.IsAlwaysZero()) return {};
  GyroscopeHistory gyroscope = gyroscope_;
  Verdicts verdicts = VerdictsBy(gyroscope, wheels);
  std::vector<Finding> findings;
  if (verdicts.num_wrong > 0) {
    // A gyroscope that reads a large rate at rest makes sound cameras look wrong.
    std::vector<const ImagePairs*> all;
    all.reserve(pairs_.size());
    for (const ImagePairs& pairs : pairs_) all.push_back(&pairs);
    const auto fit = FitGyroscope(rig_, all, gyroscope, wheels);
    const auto bias = fit ? CheckBias(*fit, imu_topic) : std::nullopt;
    Verdicts others = bias ? VerdictsBy(gyroscope_.Without(fit->bias), wheels) : verdicts;
    if (others.num_wrong < verdicts.num_wrong) {
      findings.push_back(*bias);
      verdicts = std::move(others);
      gyroscope = gyroscope_.Without(fit->bias);
    }
  }
  // Speeds with the wrong sign make all cameras contradict, which the trajectory tells better.
  if (verdicts.fit_reversed_wheels) return {};
  if (const auto fit = FitGyroscope(rig_, verdicts.right, gyroscope, wheels)) {
    if (const auto bias = CheckBias(*fit, imu_topic)) findings.push_back(*bias);
    for (Finding& finding : CheckGyroscope(*fit, imu_topic)) findings.push_back(std::move(finding));
  }
  if (!TextsOf(findings, Severity::kUnusable).empty()) return findings;
  const bool may_blame_all = verdicts.AreAllWrong() && findings.empty();
  for (size_t camera = 0; camera < topics.size(); ++camera) {
    const CameraVerdict& verdict = verdicts.cameras[camera];
    if (!verdict.is_wrong && !verdict.is_noise) continue;
    if (!verdicts.AreAllWrong())
      findings.push_back(LeftOut(verdict, rig_.cameras[camera].name, topics[camera]));
    else if (!verdict.looks_like.empty() && !verdict.is_noise && may_blame_all && findings.empty())
      findings.push_back({"cameras_contradict", Severity::kUnusable, "",
                          "what the cameras see does not move as IMU and wheels say: of " +
                              rig_.cameras[camera].name + " " + verdict.looks_like +
                              ", as it seems",
                          "", EvidenceOf(verdict)});
  }
  return findings;
}

}  // namespace parkade
