#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/evaluation/evaluate_slots.h"

namespace parkade {

/// A straight piece of a kerb as it really is.
struct TrueKerb {
  Eigen::Vector3d begin, end;  ///< [m] its foot, the ground on the left
  double height = 0;           ///< [m] above that ground
};

/// A drive is not blamed for kerbs that it did not come near, or that parked cars hid.
struct KerbScope {
  std::vector<Eigen::Vector3d> path = {};  ///< [m] where the car was; none: all true kerbs count
  SlotScope ground = {};  ///< which ground was seen: that before a kerb must have been
};

struct KerbEvaluation {
  double true_length = 0;    ///< [m] that counts
  double missed_length = 0;  ///< [m] of it
  double found_length = 0;   ///< [m]
  double right_length = 0;   ///< [m] of it that is kerb
  double recall_percent = 0, precision_percent = 0;
  double height_median = 0, height_p95 = 0;  ///< [m] of the errors' sizes along right ones
  double height_bias = 0, height_rmse = 0;   ///< [m]
  double height_normalized_rmse = 0;         ///< of errors in sigmas
};

/// Compares kerbs with the true ones, by length. `found` in the frame of the truth.
KerbEvaluation EvaluateKerbs(const std::vector<TrueKerb>& truth, const std::vector<Kerb>& found,
                             const KerbScope& scope = {});

/// A few aligned lines for people.
std::string ToText(const KerbEvaluation& evaluation);

/// Every field under its own name.
nlohmann::json ToJson(const KerbEvaluation& evaluation);

}  // namespace parkade
