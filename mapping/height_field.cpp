#include "mapping/height_field.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kNumRounds = 3;  // of re-weighting
constexpr double kTie = 1e-3;  // [1/m^2] weight of a node's own guess: next to nothing

using Coefficients = std::array<double, 4>;

/// Bilinear coefficients of the patch's nodes at (fx, fy), the fractions of its edges.
Coefficients Bilinear(double fx, double fy) { return {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}; }

}  // namespace

/// Built row by row: each row is weight * (sum_k c_k h_k - value)^2.
class HeightField::NormalEquations {
 public:
  explicit NormalEquations(int num_nodes) : right_side_(Eigen::VectorXd::Zero(num_nodes)) {}

  /// A block of rows that share four nodes: its sum of weight c c^T and of weight c value.
  void AddBlock(const std::array<int, 4>& nodes, const Eigen::Matrix4d& left, const Eigen::Vector4d& right) {
    for (int i = 0; i < 4; ++i) {
      right_side_[nodes[static_cast<size_t>(i)]] += right[i];
      for (int k = 0; k < 4; ++k)
        if (nodes[static_cast<size_t>(k)] <= nodes[static_cast<size_t>(i)])
          triplets_.emplace_back(nodes[static_cast<size_t>(i)], nodes[static_cast<size_t>(k)], left(i, k));
    }
  }

  template <size_t N>
  void AddRow(const std::array<int, N>& nodes, const std::array<double, N>& coefficients, double value, double weight) {
    for (size_t i = 0; i < N; ++i) {
      right_side_[nodes[i]] += weight * coefficients[i] * value;
      for (size_t k = 0; k < N; ++k)
        if (nodes[k] <= nodes[i])
          triplets_.emplace_back(nodes[i], nodes[k], weight * coefficients[i] * coefficients[k]);
    }
  }

  Eigen::VectorXd Solve() const {
    Eigen::SparseMatrix<double> matrix(right_side_.size(), right_side_.size());
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
    Require(factor.info() == Eigen::Success, ErrorCode::kInternal, "the heights of the ground have no solution");
    return factor.solve(right_side_);
  }

 private:
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::VectorXd right_side_;
};

void HeightFieldOptions::Validate() const {
  Require(spacing > 0, ErrorCode::kUsage, "spacing of the height field must be > 0 m");
  Require(curvature_sigma > 0, ErrorCode::kUsage, "curvature_sigma of the height field must be > 0");
  Require(level_separation > 0, ErrorCode::kUsage, "level_separation must be > 0 m");
  Require(outlier_height > 0, ErrorCode::kUsage, "outlier_height must be > 0 m");
}

HeightField::HeightField(std::vector<HeightObservation> observations, const HeightFieldOptions& options)
    : options_(options) {
  // The surest come first: they decide which decks there are.
  std::stable_sort(observations.begin(), observations.end(),
                   [](const HeightObservation& a, const HeightObservation& b) { return a.weight > b.weight; });
  MakePatches(observations);
  AddRing();
  MakeNodes();
  if (!heights_.empty()) Solve(observations);
}

HeightField::Key HeightField::KeyOf(int x, int y) {
  return (Key{static_cast<std::uint32_t>(x)} << 32) | static_cast<std::uint32_t>(y);
}

void HeightField::MakePatches(const std::vector<HeightObservation>& observations) {
  for (const HeightObservation& observation : observations) {
    const Eigen::Vector3d& point = observation.point_in_site;
    const int x = static_cast<int>(std::floor(point.x() / options_.spacing));
    const int y = static_cast<int>(std::floor(point.y() / options_.spacing));
    std::vector<int>& here = patches_at_[KeyOf(x, y)];
    const bool is_known = std::any_of(here.begin(), here.end(), [&](int patch) {
      return std::abs(patches_[static_cast<size_t>(patch)].guess - point.z()) < options_.level_separation;
    });
    if (is_known) continue;
    here.push_back(num_patches());
    patches_.push_back({x, y, {}, point.z(), 1 / std::sqrt(observation.weight)});
  }
}

void HeightField::AddRing() {
  const int num_observed = num_patches();
  for (int i = 0; i < num_observed; ++i) {
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const Patch observed = patches_[static_cast<size_t>(i)];
        std::vector<int>& here = patches_at_[KeyOf(observed.x + dx, observed.y + dy)];
        const bool is_known = std::any_of(here.begin(), here.end(), [&](int patch) {
          return std::abs(patches_[static_cast<size_t>(patch)].guess - observed.guess) < options_.level_separation;
        });
        if (is_known) continue;
        here.push_back(num_patches());
        patches_.push_back({observed.x + dx, observed.y + dy, {}, observed.guess, 2 * observed.sigma});
      }
  }
}

void HeightField::MakeNodes() {
  std::unordered_map<Key, std::vector<int>> nodes_at;
  for (Patch& patch : patches_)
    for (int corner = 0; corner < 4; ++corner) {
      std::vector<int>& here = nodes_at[KeyOf(patch.x + corner % 2, patch.y + corner / 2)];
      const auto found = std::find_if(here.begin(), here.end(), [&](int node) {
        return std::abs(heights_[static_cast<size_t>(node)] - patch.guess) < 0.5 * options_.level_separation;
      });
      if (found != here.end()) {
        patch.nodes[static_cast<size_t>(corner)] = *found;
        continue;
      }
      here.push_back(num_nodes());
      patch.nodes[static_cast<size_t>(corner)] = num_nodes();
      heights_.push_back(patch.guess);
    }
}

void HeightField::Solve(const std::vector<HeightObservation>& observations) {
  for (int round = 0; round < kNumRounds; ++round) {
    NormalEquations equations(num_nodes());
    AddThinPlate(equations);
    AddObservations(observations, /*is_first=*/round == 0, equations);
    // A node that nothing binds keeps its first guess.
    for (int node = 0; node < num_nodes(); ++node)
      equations.AddRow<1>({node}, {1}, heights_[static_cast<size_t>(node)], kTie);
    const Eigen::VectorXd solution = equations.Solve();
    heights_.assign(solution.data(), solution.data() + solution.size());
  }
}

void HeightField::AddThinPlate(NormalEquations& equations) const {
  std::vector<int> right(heights_.size(), kNone), up(heights_.size(), kNone);
  for (const Patch& patch : patches_) {
    right[static_cast<size_t>(patch.nodes[0])] = patch.nodes[1];
    right[static_cast<size_t>(patch.nodes[2])] = patch.nodes[3];
    up[static_cast<size_t>(patch.nodes[0])] = patch.nodes[2];
    up[static_cast<size_t>(patch.nodes[1])] = patch.nodes[3];
  }
  const double bend = options_.curvature_sigma * options_.spacing * options_.spacing;
  const double stiffness = 1 / (bend * bend);
  for (const std::vector<int>& next : {right, up})
    for (int node = 0; node < num_nodes(); ++node) {
      const int second = next[static_cast<size_t>(node)];
      if (second == kNone) continue;
      const int third = next[static_cast<size_t>(second)];
      if (third != kNone) equations.AddRow<3>({node, second, third}, {1, -2, 1}, 0, stiffness);
    }
  for (const Patch& patch : patches_) equations.AddRow<4>(patch.nodes, {1, -1, -1, 1}, 0, 2 * stiffness);
}

void HeightField::AddObservations(const std::vector<HeightObservation>& observations, bool is_first,
                                  NormalEquations& equations) {
  std::vector<Eigen::Matrix4d> lefts(patches_.size(), Eigen::Matrix4d::Zero());
  std::vector<Eigen::Vector4d> rights(patches_.size(), Eigen::Vector4d::Zero());
  for (const HeightObservation& observation : observations) {
    const Eigen::Vector3d& point = observation.point_in_site;
    const int index = FindPatch(point);
    if (index == kNone) continue;
    const auto i = static_cast<size_t>(index);
    Patch& patch = patches_[i];
    patch.sigma = std::min(patch.sigma, 1 / std::sqrt(observation.weight));
    const double offset = is_first ? 0 : (point.z() - HeightAt(index, point.head<2>())) / options_.outlier_height;
    const double weight = observation.weight / ((1 + offset * offset) * (1 + offset * offset));
    const Coefficients c = Bilinear(point.x() / options_.spacing - patch.x, point.y() / options_.spacing - patch.y);
    const Eigen::Map<const Eigen::Vector4d> row(c.data());
    lefts[i] += weight * row * row.transpose();
    rights[i] += weight * point.z() * row;
  }
  for (size_t i = 0; i < patches_.size(); ++i) equations.AddBlock(patches_[i].nodes, lefts[i], rights[i]);
}

int HeightField::FindPatch(const Eigen::Vector3d& point_in_site) const {
  const int x = static_cast<int>(std::floor(point_in_site.x() / options_.spacing));
  const int y = static_cast<int>(std::floor(point_in_site.y() / options_.spacing));
  const auto here = patches_at_.find(KeyOf(x, y));
  if (here == patches_at_.end()) return kNone;
  int nearest = kNone;
  double nearest_distance = options_.level_separation;
  for (const int patch : here->second) {
    const double distance = std::abs(HeightAt(patch, point_in_site.head<2>()) - point_in_site.z());
    if (distance < nearest_distance) nearest = patch, nearest_distance = distance;
  }
  return nearest;
}

double HeightField::HeightAt(int patch, const Eigen::Vector2d& point_in_site) const {
  const Patch& square = patches_[static_cast<size_t>(patch)];
  const Coefficients c =
      Bilinear(point_in_site.x() / options_.spacing - square.x, point_in_site.y() / options_.spacing - square.y);
  double height = 0;
  for (size_t k = 0; k < 4; ++k) height += c[k] * heights_[static_cast<size_t>(square.nodes[k])];
  return height;
}

}  // namespace parkade
