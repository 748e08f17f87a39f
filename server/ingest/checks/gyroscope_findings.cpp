#include "server/ingest/checks/gyroscope_findings.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace parkade {
namespace {

constexpr double kExplained = 0.93;  // share of points near their planes, where a fit is believed

/// An axis that does not read the car's turns about it.
std::optional<Finding> CheckAxes(const GyroscopeFit& fit, const std::string& imu) {
  constexpr double kWrong = 0.3, kRight = 0.6;  // of a turn that is read
  constexpr double kSigmas = 5;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double own = fit.true_from_read(axis, axis), sigma = fit.sigma(axis, axis);
    if (own > kWrong || own + kSigmas * sigma > kRight) continue;
    return Finding{
        "imu_axes",
        Severity::kUnusable,
        "",
        imu + std::string(" reads rates about ") + "xyz"[axis] +
            FormatText(" that are not what the cameras see: the car turns %.2f times as much "
                       "(to %.2f): that axis has the wrong sign, or is another one",
                       own, sigma),
        "correct the signs and the order of the driver's axes, or T_imu_body and the "
        "cameras' extrinsics",
        {{"turned_over_read", own}, {"sigma", sigma}}};
  }
  return std::nullopt;
}

std::optional<Finding> CheckGain(const GyroscopeFit& fit, const std::string& imu) {
  constexpr double kMaxSigma = 0.025, kMinError = 0.02, kSigmas = 4;
  const auto [gain, sigma] = GainOf(fit);
  if (sigma > kMaxSigma || std::abs(gain - 1) < std::max(kMinError, kSigmas * sigma))
    return std::nullopt;
  return Finding{
      kGyroscopeGain,
      Severity::kWarning,
      "",
      imu + FormatText(" reads rates that are off: by the cameras, the car turns %.3f times as "
                       "much (to %.3f)",
                       gain, sigma),
      FormatText("multiply gyroscope_scale in imu0.yaml by %.4f", gain),
      {{kRateCorrection, gain}, {"sigma", sigma}}};
}

std::optional<Finding> CheckDelay(const GyroscopeFit& fit, const std::string& imu) {
  constexpr double kMinDelay = 0.03, kSigmas = 5;  // [s]; less is left to self-calibration
  if (std::abs(fit.delay) < std::max(kMinDelay, kSigmas * fit.delay_sigma)) return std::nullopt;
  return Finding{
      kImuLate,
      Severity::kNote,
      "",
      imu + (fit.delay > 0
                 ? FormatText(" is stamped %.0f ms too late against the cameras (to %.0f), as "
                              "behind a low-pass filter, and is used so much earlier",
                              1000 * fit.delay, 1000 * fit.delay_sigma)
                 : FormatText(" is stamped %.0f ms too early against the cameras (to %.0f), "
                              "and is used so much later",
                              -1000 * fit.delay, 1000 * fit.delay_sigma)),
      "correct its driver's stamps, or timeshift_cam_imu of all cameras",
      {{kDelay, fit.delay}, {"sigma", fit.delay_sigma}}};
}

}  // namespace

std::optional<Finding> CheckBias(const GyroscopeFit& fit, const std::string& topic) {
  constexpr double kMinBias = 0.06, kSigmas = 6;  // [rad/s], beyond what cheap sensors have
  if (fit.explained < kExplained || fit.bias.norm() < std::max(kMinBias, kSigmas * fit.bias_sigma))
    return std::nullopt;
  return Finding{"gyroscope_bias",
                 Severity::kWarning,
                 topic,
                 "the IMU " + topic +
                     FormatText(" reads %.3f rad/s where the car does not turn (to %.3f)",
                                fit.bias.norm(), fit.bias_sigma),
                 "calibrate its zero, at rest",
                 {{"bias_rad_s", fit.bias.norm()}, {"sigma", fit.bias_sigma}}};
}

Finding AsErrorOfLenses(const Finding& gain) {
  const double factor = gain.evidence.at(kRateCorrection);
  return {
      "cameras_turn_otherwise",
      Severity::kWarning,
      "",
      FormatText("the cameras see the car turn %.3f times as much as IMU and wheels say (to %.3f): "
                 "their focal lengths are off, as it seems",
                 factor, gain.evidence.at("sigma")),
      "calibrate the lenses again",
      {{"turns_over_read", factor}, {"sigma", gain.evidence.at("sigma")}}};
}

Finding AsDelayOfCameras(const Finding& imu_late, bool has_wheels) {
  const double delay = -imu_late.evidence.at(kDelay);
  return {kCamerasLate,
          Severity::kNote,
          "",
          "all cameras are stamped " + FormatText("%.0f ms", 1000 * std::abs(delay)) +
              (delay > 0 ? " too late" : " too early") +
              FormatText(" against %s (to %.0f), and are used at their time",
                         has_wheels ? "IMU and wheels" : "the IMU",
                         1000 * imu_late.evidence.at("sigma")),
          "set timeshift_cam_imu of all cameras",
          {{kDelay, delay}, {"sigma", imu_late.evidence.at("sigma")}}};
}

std::vector<Finding> CheckGyroscope(const GyroscopeFit& fit, const std::string& topic) {
  const std::string imu = "the IMU " + topic;
  std::vector<Finding> findings;
  if (fit.explained < kExplained) return findings;
  if (std::optional<Finding> wrong = CheckAxes(fit, imu)) {
    findings.push_back(std::move(*wrong));
  } else {
    for (std::optional<Finding>& found :
         std::array<std::optional<Finding>, 2>{CheckGain(fit, imu), CheckDelay(fit, imu)})
      if (found) findings.push_back(std::move(*found));
  }
  for (Finding& finding : findings) finding.topic = topic;
  return findings;
}

}  // namespace parkade
