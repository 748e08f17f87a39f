#include "server/ingest/checks/gyroscope_history.h"

#include <algorithm>

#include "core/rigid3.h"

namespace parkade {

GyroscopeHistory GyroscopeHistory::Without(const Eigen::Vector3d& bias) const {
  GyroscopeHistory history = *this;
  for (Rate& rate : history.rates_) rate.rate -= bias;
  return history;
}

Eigen::Vector3d GyroscopeHistory::RateAt(Timestamp time) const {
  const auto next = std::lower_bound(rates_.begin(), rates_.end(), time,
                                     [](const Rate& rate, Timestamp t) { return rate.time < t; });
  if (next == rates_.end()) return Eigen::Vector3d::Zero();
  if (next == rates_.begin()) return next->rate;
  const auto before = std::prev(next);
  const double share = (time - before->time) / (next->time - before->time);
  return before->rate + share * (next->rate - before->rate);
}

std::optional<Eigen::Quaterniond> GyroscopeHistory::Rotation(Timestamp first, Timestamp second,
                                                             std::size_t& hint) const {
  constexpr double kMaxMissing = 0.1;  // [s]
  while (hint + 1 < rates_.size() && rates_[hint + 1].time <= first) ++hint;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (std::size_t i = hint; i + 1 < rates_.size(); ++i) {
    const Timestamp begin = std::max(rates_[i].time, first),
                    end = std::min(rates_[i + 1].time, second);
    if (rates_[i + 1].time - rates_[i].time > kMaxMissing) return std::nullopt;
    turn = turn * ExpSo3(0.5 * (rates_[i].rate + rates_[i + 1].rate) * (end - begin));
    if (rates_[i + 1].time >= second) return turn;
  }
  return std::nullopt;
}

}  // namespace parkade
