#include "tests/slam/worlds/synthetic_pose_graph.h"

#include <random>

#include "slam/georeference/align_points.h"
#include "slam/pose_graph/pose_graph_start.h"

namespace parkade {
namespace {

/// std::normal_distribution differs between libraries; this does not.
class Noise {
 public:
  explicit Noise(std::uint32_t seed) : random_(seed) {}
  double Uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  double Normal() { return std::sqrt(-2 * std::log(Uniform())) * std::cos(2 * M_PI * Uniform()); }
  Eigen::Vector3d NormalVector(double sigma) {
    const double x = Normal(), y = Normal(), z = Normal();
    return sigma * Eigen::Vector3d(x, y, z);
  }
  size_t Index(size_t size) {
    return std::min(size - 1, static_cast<size_t>(Uniform() * static_cast<double>(size)));
  }

 private:
  std::mt19937 random_;
};

/// Lanes of 20 m, 5 m apart, driven up and down; the second half of the drive repeats the first
/// with a small offset.
std::vector<Rigid3> DriveLanes(int num_poses, bool is_planar) {
  std::vector<Rigid3> poses;
  const int half = num_poses / 2, per_lane = 20;
  for (int i = 0; i < num_poses; ++i) {
    const int step = i % half, lane = step / per_lane, along = step % per_lane;
    const bool is_up = lane % 2 == 0;
    const double height = is_planar ? 0 : 0.3 * std::sin(0.1 * step);
    const Eigen::Vector3d position(is_up ? along : per_lane - along,
                                   5.0 * lane + (i < half ? 0 : 0.4), height);
    const double yaw = is_up ? 0 : M_PI;
    poses.push_back(
        {ExpSo3({0, 0, yaw}) * ExpSo3({0, is_planar ? 0 : 0.05 * std::cos(0.1 * step), 0}),
         position});
  }
  return poses;
}

PoseGraphEdge Measure(const std::vector<Rigid3>& truth, size_t from, size_t to,
                      const SyntheticGraphOptions& options, Noise& noise) {
  PoseGraphEdge edge;
  edge.from = from;
  edge.to = to;
  edge.is_trusted = to == from + 1;
  Eigen::Vector3d turn = noise.NormalVector(options.rotation_sigma);
  Eigen::Vector3d shift = noise.NormalVector(options.translation_sigma);
  if (options.is_planar) {
    turn.head<2>().setZero();
    shift.z() = 0;
  }
  edge.from_from_to = truth[from].Inverse() * truth[to] * Rigid3{ExpSo3(turn), shift};
  Vector6d information;
  information << Eigen::Vector3d::Constant(1 / std::pow(options.translation_sigma, 2)),
      Eigen::Vector3d::Constant(1 / std::pow(options.rotation_sigma, 2));
  if (options.is_planar) information.segment<3>(2).setZero();
  edge.information = information.asDiagonal();
  return edge;
}

}  // namespace

std::vector<Rigid3> PosesOf(const PoseGraph& graph) {
  std::vector<Rigid3> poses;
  for (const PoseGraphVertex& vertex : graph.vertices) poses.push_back(vertex.world_from_vertex);
  return poses;
}

SyntheticGraph MakeSyntheticGraph(const SyntheticGraphOptions& options) {
  Noise noise(options.seed);
  SyntheticGraph made;
  made.truth = DriveLanes(options.num_poses, options.is_planar);
  made.graph.is_planar = options.is_planar;
  for (size_t i = 0; i < made.truth.size(); ++i)
    made.graph.vertices.push_back({static_cast<std::int64_t>(i), made.truth.front(), false});
  for (size_t i = 0; i + 1 < made.truth.size(); ++i)
    made.graph.edges.push_back(Measure(made.truth, i, i + 1, options, noise));
  const size_t half = made.truth.size() / 2;
  for (size_t i = 0; i < half; i += 2) {
    made.graph.edges.push_back(Measure(made.truth, i, half + i, options, noise));
    ++made.num_right_loops;
  }
  const std::vector<Rigid3> odometry = ChainEdges(made.graph);
  for (size_t i = 0; i < odometry.size(); ++i)
    made.graph.vertices[i].world_from_vertex = odometry[i];
  const size_t before = made.graph.edges.size();
  AddWrongLoops(made.truth, options.wrong_share, options.seed + 1000, made.graph);
  made.num_wrong_loops = made.graph.edges.size() - before;
  return made;
}

void AddWrongLoops(const std::vector<Rigid3>& placed, double share, std::uint32_t seed,
                   PoseGraph& graph) {
  Noise noise(seed);
  Eigen::AlignedBox3d box;
  for (const Rigid3& pose : placed) box.extend(pose.translation);
  std::vector<Matrix6d> informations;
  for (const PoseGraphEdge& edge : graph.edges)
    if (!edge.is_trusted) informations.push_back(edge.information);
  const auto count = static_cast<size_t>(
      std::lround(share / (1 - share) * static_cast<double>(informations.size())));
  for (size_t i = 0; i < count;) {
    PoseGraphEdge edge;
    edge.from = noise.Index(placed.size());
    edge.to = noise.Index(placed.size());
    if (std::max(edge.from, edge.to) - std::min(edge.from, edge.to) < 10) continue;
    for (int k = 0; k < 3; ++k)
      edge.from_from_to.translation[k] = (noise.Uniform() - 0.5) * box.sizes()[k];
    const Eigen::Vector3d axis = noise.NormalVector(1);
    const double w = noise.Normal();
    edge.from_from_to.rotation = Eigen::Quaterniond(w, axis.x(), axis.y(), axis.z()).normalized();
    if (graph.is_planar)
      edge.from_from_to.rotation = ExpSo3({0, 0, 2 * M_PI * noise.Uniform() - M_PI});
    edge.information = informations[noise.Index(informations.size())];
    graph.edges.push_back(edge);
    ++i;
  }
}

void AddAlikeStretches(const std::vector<Rigid3>& placed, double share, size_t group,
                       std::uint32_t seed, PoseGraph& graph) {
  Noise noise(seed);
  std::vector<Matrix6d> informations;
  for (const PoseGraphEdge& edge : graph.edges)
    if (!edge.is_trusted) informations.push_back(edge.information);
  const double wanted = share / (1 - share) * static_cast<double>(informations.size());
  size_t num_added = 0;
  while (static_cast<double>(num_added) < wanted) {
    const size_t first = noise.Index(placed.size() - group),
                 second = noise.Index(placed.size() - group);
    const Rigid3& there = placed[second];
    const Rigid3 here_from_there = placed[first] * there.Inverse();
    // Where the second stretch truly is beside the first, nothing would be wrong.
    if (std::max(first, second) - std::min(first, second) < 2 * group ||
        (there.translation - placed[first].translation).norm() < 3)
      continue;
    for (size_t i = 0; i < group; ++i) {
      PoseGraphEdge edge;
      edge.from = first + i;
      edge.to = second + i;
      edge.from_from_to = placed[edge.from].Inverse() * here_from_there * placed[edge.to];
      edge.information = informations[noise.Index(informations.size())];
      graph.edges.push_back(edge);
      ++num_added;
    }
  }
}

double PositionError(const std::vector<Rigid3>& truth, const PoseGraph& graph) {
  Eigen::Matrix3Xd source(3, static_cast<Eigen::Index>(truth.size())), target = source;
  for (Eigen::Index i = 0; i < source.cols(); ++i) {
    source.col(i) = graph.vertices[static_cast<size_t>(i)].world_from_vertex.translation;
    target.col(i) = truth[static_cast<size_t>(i)].translation;
  }
  const Rigid3 truth_from_world = AlignPoints(source, target).target_from_source;
  double sum = 0;
  for (Eigen::Index i = 0; i < source.cols(); ++i)
    sum += (truth_from_world * Eigen::Vector3d(source.col(i)) - target.col(i)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(source.cols()));
}

}  // namespace parkade
