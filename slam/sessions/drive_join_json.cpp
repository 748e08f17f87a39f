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

/// A link but for what became of it.
nlohmann::json LinkJson(const SessionLoop& link, const LinkEnds& ends,
                        const std::vector<std::string>& names) {
  const Eigen::Vector3d& t = link.pose.a_from_b.translation;
  const Eigen::Vector3d turn = LogSo3(link.pose.a_from_b.rotation);
  nlohmann::json information = nlohmann::json::array();  // upper triangle, row by row
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      information.push_back(link.pose.information(row, column));
  return {{"id", NameOf(ends, names)},
          {"place_a", link.keyframe_a},
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
          {"rotation_vector", {turn.x(), turn.y(), turn.z()}}};
}

const char* StateOf(const DrivePair& pair, size_t link) {
  if (pair.IsForced(link)) return "forced by the reviewer";
  return pair.weights[link] > 0.5 ? "accepted" : "rejected by the pose graph";
}

nlohmann::json LinksJson(const DrivePair& pair, const std::vector<std::string>& names) {
  const auto json_of = [&](const SessionLoop& link, double chi_squared, double weight,
                           const char* state) {
    nlohmann::json json =
        LinkJson(link, {pair.drive_a, link.keyframe_a, pair.drive_b, link.keyframe_b}, names);
    json["chi_squared"] = chi_squared;
    json["weight"] = weight;
    json["state"] = state;
    return json;
  };
  nlohmann::json links = nlohmann::json::array();
  for (size_t i = 0; i < pair.found.links.size(); ++i)
    links.push_back(
        json_of(pair.found.links[i], pair.chi_squared[i], pair.weights[i], StateOf(pair, i)));
  for (const RejectedLink& rejected : pair.rejected)
    links.push_back(json_of(rejected.link, rejected.chi_squared, 0, "rejected by the reviewer"));
  return links;
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
    json["pairs"].push_back({{"a", names[pair.drive_a]},
                             {"b", names[pair.drive_b]},
                             {"num_candidates", pair.found.num_candidates},
                             {"num_measured", pair.found.num_measured},
                             {"num_agreeing", pair.found.num_agreeing},
                             {"num_rivals", pair.found.num_rivals},
                             {"floor", FloorJson(pair.found.floor)},
                             {"num_accepted", pair.num_accepted()},
                             {"rejected", pair.found.rejected},
                             {"links", LinksJson(pair, names)}});
  }
  return json;
}

}  // namespace parkade
