#include "slam/sessions/drive_join_json.h"

#include <nlohmann/json.hpp>

namespace parkade {
namespace {

nlohmann::json FloorJson(const BevEvidence& floor) {
  return {{"tiles_within", floor.within.num_tiles},
          {"best_within", floor.within.num_best},
          {"tiles_across", floor.across.num_tiles},
          {"best_across", floor.across.num_best}};
}

}  // namespace

nlohmann::json ToJson(const DriveJoin& join, const std::vector<std::string>& names) {
  const JointAdjustment& adjustment = join.adjustment;
  nlohmann::json json = {{"seconds", join.seconds},
                         {"adjustment",
                          {{"num_links", adjustment.num_links},
                           {"before", adjustment.before},
                           {"after", adjustment.after},
                           {"largest_correction", adjustment.largest_correction},
                           {"seconds", adjustment.seconds}}},
                         {"pairs", nlohmann::json::array()}};
  for (const DrivePair& pair : join.pairs) {
    nlohmann::json links = nlohmann::json::array();
    for (size_t i = 0; i < pair.found.links.size(); ++i) {
      const SessionLoop& link = pair.found.links[i];
      const Eigen::Vector3d& t = link.pose.a_from_b.translation;
      const Eigen::Vector3d turn = LogSo3(link.pose.a_from_b.rotation);
      nlohmann::json information = nlohmann::json::array();  // upper triangle, row by row
      for (int row = 0; row < 6; ++row)
        for (int column = row; column < 6; ++column)
          information.push_back(link.pose.information(row, column));
      links.push_back({{"place_a", link.keyframe_a},
                       {"place_b", link.keyframe_b},
                       {"time_a", static_cast<double>(link.pose.shown.image_a.ns) * 1e-9},
                       {"time_b", static_cast<double>(link.pose.shown.image_b.ns) * 1e-9},
                       {"score", link.score},
                       {"num_inliers", link.pose.num_inliers},
                       {"num_camera_pairs", link.pose.num_camera_pairs},
                       {"inliers", ToJson(link.pose.shown)},
                       {"residual", link.pose.residual},
                       {"worst_sigma", link.pose.worst_sigma},
                       {"information", information},
                       {"translation", {t.x(), t.y(), t.z()}},
                       {"rotation_vector", {turn.x(), turn.y(), turn.z()}},
                       {"chi_squared", pair.chi_squared[i]},
                       {"weight", pair.weights[i]}});
    }
    json["pairs"].push_back({{"a", names[pair.drive_a]},
                             {"b", names[pair.drive_b]},
                             {"num_candidates", pair.found.num_candidates},
                             {"num_measured", pair.found.num_measured},
                             {"num_agreeing", pair.found.num_agreeing},
                             {"num_rivals", pair.found.num_rivals},
                             {"floor", FloorJson(pair.found.floor)},
                             {"num_accepted", pair.num_accepted()},
                             {"rejected", pair.found.rejected},
                             {"links", links}});
  }
  return json;
}

}  // namespace parkade
