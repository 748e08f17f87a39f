#include "slam/join_drives.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"
#include "slam/place_graph.h"
#include "slam/robust_pose_graph.h"

namespace parkade {
namespace {

constexpr std::int64_t kIdsPerDrive = 1'000'000'000;

double Square(double x) { return x * x; }

/// [m] by which a drive may lie off, where GNSS puts it.
double SigmaOf(const GnssAlignment& gnss) {
  return std::sqrt(gnss.covariance(1, 1) + gnss.covariance(2, 2) + gnss.covariance(0, 0) * Square(gnss.extent));
}

DrivePair LinkPair(const std::vector<DriveToJoin>& drives, size_t a, size_t b, const LoopOptions& loops,
                   const DriveLinkOptions& options) {
  DrivePair pair{a, b, {}, {}, {}};
  std::optional<Rigid3> a_from_b;
  double sigma = 0;
  if (drives[a].gnss && drives[b].gnss) {
    a_from_b = drives[a].gnss->site_from_odom.Inverse() * drives[b].gnss->site_from_odom;
    sigma = std::hypot(SigmaOf(*drives[a].gnss), SigmaOf(*drives[b].gnss));
  }
  pair.found = LinkDrives(drives[a].places, drives[b].places, options, loops.relative_pose, a_from_b, sigma);
  pair.weights.assign(pair.found.links.size(), 1);
  pair.chi_squared.assign(pair.found.links.size(), 0);
  return pair;
}

/// Drives that hang together have the same number, the lowest of their indices.
std::vector<size_t> FindGroups(const std::vector<DriveToJoin>& drives, const std::vector<DrivePair>& pairs) {
  std::vector<size_t> group(drives.size());
  std::iota(group.begin(), group.end(), size_t{0});
  const auto join = [&group](size_t a, size_t b) {
    const auto [to, from] = std::minmax({group[a], group[b]});
    std::replace(group.begin(), group.end(), size_t{from}, size_t{to});
  };
  std::optional<size_t> placed;
  for (size_t i = 0; i < drives.size(); ++i) {
    if (!drives[i].gnss) continue;
    if (placed) join(*placed, i);
    placed = i;
  }
  for (const DrivePair& pair : pairs)
    if (pair.num_accepted() > 0) join(pair.drive_a, pair.drive_b);
  return group;
}

/// The group with the most drives, then with the longest way.
size_t ChooseGroup(const std::vector<DriveToJoin>& drives, const std::vector<size_t>& groups) {
  std::vector<std::pair<int, double>> sizes(drives.size());
  for (size_t i = 0; i < drives.size(); ++i) {
    ++sizes[groups[i]].first;
    sizes[groups[i]].second += drives[i].odom_from_body.Length();
  }
  return static_cast<size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

/// Where the drives' odometry frames lie before the joint graph: from GNSS, or else link by link from drives that are
/// placed. Empty for drives outside the group.
std::vector<std::optional<Rigid3>> StartFrames(const std::vector<DriveToJoin>& drives,
                                               const std::vector<DrivePair>& pairs, const std::vector<size_t>& groups,
                                               size_t group) {
  std::vector<std::optional<Rigid3>> site_from_odom(drives.size());
  for (size_t i = 0; i < drives.size(); ++i)
    if (groups[i] == group && drives[i].gnss) site_from_odom[i] = drives[i].gnss->site_from_odom;
  if (std::none_of(site_from_odom.begin(), site_from_odom.end(), [](const auto& pose) { return pose.has_value(); }))
    site_from_odom[group].emplace();
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (const DrivePair& pair : pairs) {
      std::optional<Rigid3>&a = site_from_odom[pair.drive_a], &b = site_from_odom[pair.drive_b];
      if (pair.num_accepted() == 0 || a.has_value() == b.has_value()) continue;
      const PlaceLink& link = pair.found.links[pair.found.links.size() / 2];
      const Place& place_a = drives[pair.drive_a].places[link.place_a];
      const Place& place_b = drives[pair.drive_b].places[link.place_b];
      const Rigid3 odom_a_from_b = place_a.odom_from_place * link.pose.a_from_b * place_b.odom_from_place.Inverse();
      if (a) {
        b = *a * odom_a_from_b;
      } else {
        a = *b * odom_a_from_b.Inverse();
      }
      is_changed = true;
    }
  }
  return site_from_odom;
}

/// What GNSS says about the drive as a whole, as an edge from the world to the place nearest to the fixes' centre.
PoseGraphEdge GnssEdge(const DriveToJoin& drive, size_t first_vertex) {
  const std::vector<Place>& places = drive.places;
  const GnssAlignment& gnss = *drive.gnss;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the drive, as good as that of the fixes
  for (const Place& place : places) centre += place.odom_from_place.translation / static_cast<double>(places.size());
  const auto nearest = std::min_element(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    return (a.odom_from_place.translation - centre).squaredNorm() <
           (b.odom_from_place.translation - centre).squaredNorm();
  });
  const Rigid3 site_from_place = gnss.site_from_odom * nearest->odom_from_place;
  const Eigen::Vector3d arm = gnss.site_from_odom.rotation * (nearest->odom_from_place.translation - centre);
  Eigen::Matrix4d by_centre = Eigen::Matrix4d::Identity();  // [x, y, z, yaw] of the place by [yaw, x, y, z]
  by_centre << -arm.y(), 1, 0, 0, arm.x(), 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0;
  const Eigen::Matrix4d information = (by_centre * gnss.covariance * by_centre.transpose()).inverse();
  Eigen::Matrix<double, 6, 4> to_place = Eigen::Matrix<double, 6, 4>::Zero();
  to_place.topLeftCorner<3, 3>() = site_from_place.rotation.conjugate().toRotationMatrix();
  to_place(5, 3) = 1;
  return {0, first_vertex + static_cast<size_t>(nearest - places.begin()), site_from_place,
          to_place * information * to_place.transpose(), false};
}

/// All places of the kept drives as one graph.
class JointGraph {
 public:
  JointGraph(const std::vector<DriveToJoin>& drives, const std::vector<std::optional<Rigid3>>& site_from_odom,
             const LoopOptions& options)
      : graph_(WorldGraph()), first_vertex_(drives.size()) {
    bool is_placed = false;
    for (size_t i = 0; i < drives.size(); ++i) {
      if (!site_from_odom[i]) continue;
      std::vector<Rigid3> poses;
      for (const Place& place : drives[i].places) poses.push_back(*site_from_odom[i] * place.odom_from_place);
      first_vertex_[i] =
          AddPlaces(drives[i].places, poses, options, kIdsPerDrive * static_cast<std::int64_t>(i), graph_);
      AddOwnLoops(drives[i], first_vertex_[i]);
      if (drives[i].gnss) graph_.edges.push_back(GnssEdge(drives[i], first_vertex_[i]));
      is_placed = is_placed || drives[i].gnss;
    }
    if (!is_placed) graph_.vertices[1].is_fixed = true;
  }

  void AddLinks(const DrivePair& pair) {
    first_link_.push_back(graph_.edges.size());
    for (const PlaceLink& link : pair.found.links)
      graph_.edges.push_back({first_vertex_[pair.drive_a] + link.place_a, first_vertex_[pair.drive_b] + link.place_b,
                              link.pose.a_from_b, link.pose.information, false});
  }

  /// Sets the weights of the pairs in the order in which their links were added.
  void Solve(const std::vector<DrivePair*>& pairs) {
    RobustPoseGraphOptions robust;
    robust.graph.objective = "information";
    robust.adapts_noise = false;
    const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly(robust, graph_);
    for (size_t i = 0; i < pairs.size(); ++i) {
      for (size_t k = 0; k < pairs[i]->found.links.size(); ++k) {
        pairs[i]->weights[k] = summary.weights[first_link_[i] + k];
        pairs[i]->chi_squared[k] = summary.chi_squared[first_link_[i] + k];
      }
    }
  }

  std::vector<Rigid3> Poses(size_t drive, size_t num_places) const {
    std::vector<Rigid3> poses;
    for (size_t i = 0; i < num_places; ++i)
      poses.push_back(graph_.vertices[first_vertex_[drive] + i].world_from_vertex);
    return poses;
  }

 private:
  /// The final trajectory has them closed: they only hold it together as firmly as they were measured.
  void AddOwnLoops(const DriveToJoin& drive, size_t first_vertex) {
    const std::vector<Place>& places = drive.places;
    for (const LoopEvidence& loop : drive.loops.loops) {
      if (loop.weight < 0.5 || loop.pose.information.diagonal().minCoeff() <= 0) continue;
      graph_.edges.push_back(
          {first_vertex + loop.earlier_place, first_vertex + loop.later_place,
           places[loop.earlier_place].odom_from_place.Inverse() * places[loop.later_place].odom_from_place,
           loop.pose.information, true});
    }
  }

  PoseGraph graph_;
  std::vector<size_t> first_vertex_;  ///< per drive
  std::vector<size_t> first_link_;    ///< per pair: its first edge
};

std::string ReasonFor(size_t drive, const std::vector<DrivePair>& pairs) {
  const DrivePair* nearest = nullptr;
  for (const DrivePair& pair : pairs)
    if ((pair.drive_a == drive || pair.drive_b == drive) &&
        (!nearest || pair.found.num_agreeing > nearest->found.num_agreeing))
      nearest = &pair;
  if (!nearest) return "there is no other drive";
  return nearest->found.rejected.empty() ? "its links contradict those of other drives" : nearest->found.rejected;
}

}  // namespace

std::vector<Place> PlacesAlong(const DriveLog& log, const Trajectory& odometry, const Trajectory& odom_from_body,
                               const PlaceOptions& options) {
  std::vector<Place> places = ChoosePlaces(odometry, options);
  for (Place& place : places) place.odom_from_place = LevelledPose(*odom_from_body.At(place.time));
  DescribePlaces(log, odom_from_body, options, std::vector<bool>(places.size(), true), places);
  return places;
}

int DrivePair::num_accepted() const {
  return static_cast<int>(std::count_if(weights.begin(), weights.end(), [](double weight) { return weight > 0.5; }));
}

DriveJoin JoinDrives(const std::vector<DriveToJoin>& drives, const LoopOptions& loops, const DriveLinkOptions& links) {
  links.Validate();
  const auto start = std::chrono::steady_clock::now();
  DriveJoin join;
  join.drives.resize(drives.size());
  if (drives.size() == 1) {
    join.drives[0].site_from_body =
        drives[0].odom_from_body.Transformed(drives[0].gnss ? drives[0].gnss->site_from_odom : Rigid3{});
    return join;
  }
  for (size_t b = 1; b < drives.size(); ++b)
    for (size_t a = 0; a < b; ++a) join.pairs.push_back(LinkPair(drives, a, b, loops, links));

  // Links that the joint graph rejects may leave drives apart that seemed to hang together.
  std::vector<size_t> groups = FindGroups(drives, join.pairs), before;
  size_t group = 0;
  std::vector<std::vector<Rigid3>> poses(drives.size());
  while (groups != before) {
    group = ChooseGroup(drives, groups);
    const std::vector<std::optional<Rigid3>> frames = StartFrames(drives, join.pairs, groups, group);
    JointGraph graph(drives, frames, loops);
    std::vector<DrivePair*> used;
    for (DrivePair& pair : join.pairs) {
      if (groups[pair.drive_a] != group || groups[pair.drive_b] != group || pair.num_accepted() == 0) continue;
      graph.AddLinks(pair);
      used.push_back(&pair);
    }
    graph.Solve(used);
    for (size_t i = 0; i < drives.size(); ++i)
      if (frames[i]) poses[i] = graph.Poses(i, drives[i].places.size());
    before = groups;
    groups = FindGroups(drives, join.pairs);
  }
  for (size_t i = 0; i < drives.size(); ++i) {
    if (groups[i] == group) {
      join.drives[i].site_from_body = CarryAlong(drives[i].odom_from_body, drives[i].places, poses[i]);
    } else {
      join.drives[i].left_out = ReasonFor(i, join.pairs);
    }
  }
  join.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return join;
}

nlohmann::json ToJson(const DriveJoin& join, const std::vector<std::string>& names) {
  nlohmann::json json = {{"seconds", join.seconds}, {"pairs", nlohmann::json::array()}};
  for (const DrivePair& pair : join.pairs) {
    nlohmann::json links = nlohmann::json::array();
    for (size_t i = 0; i < pair.found.links.size(); ++i) {
      const PlaceLink& link = pair.found.links[i];
      const Eigen::Vector3d& t = link.pose.a_from_b.translation;
      const Eigen::Vector3d turn = LogSo3(link.pose.a_from_b.rotation);
      links.push_back({{"place_a", link.place_a},
                       {"place_b", link.place_b},
                       {"score", link.score},
                       {"num_inliers", link.pose.num_inliers},
                       {"num_camera_pairs", link.pose.num_camera_pairs},
                       {"residual", link.pose.residual},
                       {"worst_sigma", link.pose.worst_sigma},
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
                             {"num_accepted", pair.num_accepted()},
                             {"rejected", pair.found.rejected},
                             {"links", links}});
  }
  return json;
}

}  // namespace parkade
