#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace parkade {

struct LucasKanadeOptions {
  int window = 17;              ///< [px] odd edge of the patch, up to FlowPatch::kMaxEdge
  double max_round_trip = 0.7;  ///< [px] forward-backward error above which a point counts as lost
};

/// Follows points from one image into the next and back again. Pyramids as from BuildPyramid.
///
/// \param before  [px] of the points in the pyramid `from`
/// \param start   [px] where they should be in `to`; points without one are not looked for
/// \return per point: its pixel in `to`; nothing where it was lost or does not find back
///
/// J.-Y. Bouguet, "Pyramidal implementation of the affine Lucas Kanade feature tracker", 2001, with
/// the steps of FlowPatch.
std::vector<std::optional<Eigen::Vector2d>> FollowThereAndBack(
    const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
    const std::vector<Eigen::Vector2d>& before,
    const std::vector<std::optional<Eigen::Vector2d>>& start, const LucasKanadeOptions& options);

}  // namespace parkade
