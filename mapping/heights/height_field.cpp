#include "mapping/heights/height_field.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/math/fast_floor.h"
#include "core/math/sparse_cholesky.h"
#include "core/parallel.h"

namespace parkade {
namespace {

constexpr double kOutlierHeight =
    0.1;                              // [m] off the surface from which an observation loses its say
constexpr int kNumRoundsOfSteps = 6;  // of re-weighting where the surface may break
constexpr double kBreakingBend = 0.003;  // [m] second difference at which it gives way
constexpr int kNumRounds = 3;            // of re-weighting
constexpr double kTie = 1e-3;            // [1/m^2] weight of a node's own guess: next to nothing

using Coefficients = std::array<double, 4>;

/// Bilinear coefficients of the patch's nodes at (fx, fy), the fractions of its edges.
Coefficients Bilinear(double fx, double fy) {
  return {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
}

double Bilinear(const std::array<float, 4>& heights, double fx, double fy) {
  const auto a = static_cast<double>(heights[0]), b = static_cast<double>(heights[1]);
  const auto c = static_cast<double>(heights[2]), d = static_cast<double>(heights[3]);
  return (1 - fy) * (a + fx * (b - a)) + fy * (c + fx * (d - c));
}

}  // namespace

/// Built row by row: each row is weight * (sum_k c_k h_k - value)^2.
class HeightField::NormalEquations {
 public:
  explicit NormalEquations(int num_nodes) : right_side_(Eigen::VectorXd::Zero(num_nodes)) {}

  /// A block of rows that share four nodes: its sum of weight c c^T and of weight c value.
  void AddBlock(const std::array<int, 4>& nodes, const Eigen::Matrix4d& left,
                const Eigen::Vector4d& right) {
    for (int i = 0; i < 4; ++i) {
      right_side_[nodes[static_cast<size_t>(i)]] += right[i];
      for (int k = 0; k < 4; ++k)
        if (nodes[static_cast<size_t>(k)] <= nodes[static_cast<size_t>(i)])
          triplets_.emplace_back(nodes[static_cast<size_t>(i)], nodes[static_cast<size_t>(k)],
                                 left(i, k));
    }
  }

  template <size_t N>
  void AddRow(const std::array<int, N>& nodes, const std::array<double, N>& coefficients,
              double value, double weight) {
    for (size_t i = 0; i < N; ++i) {
      right_side_[nodes[i]] += weight * coefficients[i] * value;
      for (size_t k = 0; k < N; ++k)
        if (nodes[k] <= nodes[i])
          triplets_.emplace_back(nodes[i], nodes[k], weight * coefficients[i] * coefficients[k]);
    }
  }

  /// Ends the equations: their rows, which take more than the matrix, are let go before it is
  /// factored.
  Eigen::VectorXd Solve(CholeskySolver& solver) && {
    Eigen::SparseMatrix<double> matrix(right_side_.size(), right_side_.size());
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    triplets_ = {};
    return solver.Solve(matrix, right_side_);
  }

 private:
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::VectorXd right_side_;
};

void HeightFieldOptions::Validate() const {
  Require(spacing > 0, ErrorCode::kUsage, "spacing of the height field must be > 0 m");
  Require(curvature_sigma > 0, ErrorCode::kUsage,
          "curvature_sigma of the height field must be > 0");
  Require(level_separation > 0, ErrorCode::kUsage, "level_separation must be > 0 m");
}

HeightField::HeightField(std::vector<HeightObservation> observations,
                         const HeightFieldOptions& options, const HeightField* before)
    : options_(options), squares_per_meter_(1 / options.spacing) {
  // The surest come first: they decide which decks there are.
  std::stable_sort(
      observations.begin(), observations.end(),
      [](const HeightObservation& a, const HeightObservation& b) { return a.weight > b.weight; });
  MakePatches(observations);
  AddRing();
  NumberByPlace();
  MakeNodes();
  if (!heights_.empty()) Solve(observations, before);
  KeepMeasured(observations);
}

void HeightField::KeepMeasured(const std::vector<HeightObservation>& observations) {
  for (const HeightObservation& observation : observations) {
    const int patch = observation.is_swept ? FindPatch(observation.point_in_site) : kNone;
    if (patch == kNone) continue;
    MeasuredHeight& measured = patches_[static_cast<size_t>(patch)].measured;
    measured.weight += observation.weight;
    measured.height +=
        observation.weight / measured.weight * (observation.point_in_site.z() - measured.height);
  }
}

bool HeightField::HasPatchNear(int x, int y, double height) const {
  for (int patch = patches_at_.First(x, y); patch != kNone; patch = patches_at_.Next(patch))
    if (std::abs(patches_[static_cast<size_t>(patch)].guess - height) < options_.level_separation)
      return true;
  return false;
}

void HeightField::AddPatch(const Patch& patch) {
  patches_at_.Add(patch.x, patch.y);
  patches_.push_back(patch);
}

void HeightField::MakePatches(const std::vector<HeightObservation>& observations) {
  for (const HeightObservation& observation : observations) {
    const Eigen::Vector3d& point = observation.point_in_site;
    const int x = FastFloor(SquaresOf(point.x())), y = FastFloor(SquaresOf(point.y()));
    if (!HasPatchNear(x, y, point.z()))
      AddPatch({.x = x, .y = y, .guess = point.z(), .sigma = observation.Sigma()});
  }
}

void HeightField::AddRing() {
  const int num_observed = num_patches();
  for (int i = 0; i < num_observed; ++i) {
    const Patch observed = patches_[static_cast<size_t>(i)];
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (!HasPatchNear(observed.x + dx, observed.y + dy, observed.guess))
          AddPatch({.x = observed.x + dx,
                    .y = observed.y + dy,
                    .guess = observed.guess,
                    .sigma = 2 * observed.sigma});
  }
}

/// What lies side by side is looked up together: it had better lie side by side in memory.
void HeightField::NumberByPlace() {
  constexpr int kBits = 4;  // squares of 16 by 16
  const auto place = [](const Patch& patch) {
    return std::tuple(patch.y >> kBits, patch.x >> kBits, patch.y, patch.x);
  };
  std::stable_sort(patches_.begin(), patches_.end(),
                   [&](const Patch& a, const Patch& b) { return place(a) < place(b); });
  patches_at_ = {};
  for (const Patch& patch : patches_) patches_at_.Add(patch.x, patch.y);
}

void HeightField::MakeNodes() {
  PatchIndex nodes_at;
  for (Patch& patch : patches_)
    for (int corner = 0; corner < 4; ++corner) {
      const int x = patch.x + corner % 2, y = patch.y + corner / 2;
      int node = nodes_at.First(x, y);
      while (node != kNone && std::abs(heights_[static_cast<size_t>(node)] - patch.guess) >=
                                  0.5 * options_.level_separation)
        node = nodes_at.Next(node);
      if (node == kNone) {
        node = num_nodes();
        nodes_at.Add(x, y);
        heights_.push_back(patch.guess);
      }
      patch.nodes[static_cast<size_t>(corner)] = node;
    }
  KeepHeights();
}

void HeightField::KeepHeights() {
  corners_.resize(patches_.size());
  for (size_t i = 0; i < patches_.size(); ++i)
    for (size_t k = 0; k < 4; ++k)
      corners_[i][k] = static_cast<float>(heights_[static_cast<size_t>(patches_[i].nodes[k])]);
}

void HeightField::Solve(const std::vector<HeightObservation>& observations,
                        const HeightField* before) {
  CholeskySolver solver;
  const HeightField* weighed_by = before;
  const int num_rounds = options_.has_steps ? kNumRoundsOfSteps : kNumRounds;
  for (int round = before ? 1 : 0; round < num_rounds; ++round) {
    NormalEquations equations(num_nodes());
    AddThinPlate(options_.has_steps && round > 0, equations);
    AddObservations(observations, weighed_by, equations);
    // A node that nothing binds keeps its first guess.
    for (int node = 0; node < num_nodes(); ++node)
      equations.AddRow<1>({node}, {1}, heights_[static_cast<size_t>(node)], kTie);
    const Eigen::VectorXd solution = std::move(equations).Solve(solver);
    heights_.assign(solution.data(), solution.data() + solution.size());
    KeepHeights();
    weighed_by = this;
  }
}

/// \param breaks  where the last solution bends too much, it breaks
void HeightField::AddThinPlate(bool breaks, NormalEquations& equations) const {
  std::vector<int> right(heights_.size(), kNone), up(heights_.size(), kNone);
  for (const Patch& patch : patches_) {
    right[static_cast<size_t>(patch.nodes[0])] = patch.nodes[1];
    right[static_cast<size_t>(patch.nodes[2])] = patch.nodes[3];
    up[static_cast<size_t>(patch.nodes[0])] = patch.nodes[2];
    up[static_cast<size_t>(patch.nodes[1])] = patch.nodes[3];
  }
  const double bend = options_.curvature_sigma * options_.spacing * options_.spacing;
  const double stiffness = 1 / (bend * bend);
  const auto height = [&](int node) { return heights_[static_cast<size_t>(node)]; };
  const auto stiffness_at = [&](double difference) {
    const double strain = breaks ? difference / kBreakingBend : 0;
    return stiffness / ((1 + strain * strain) * (1 + strain * strain));
  };
  for (const std::vector<int>& next : {right, up})
    for (int node = 0; node < num_nodes(); ++node) {
      const int second = next[static_cast<size_t>(node)];
      if (second == kNone) continue;
      const int third = next[static_cast<size_t>(second)];
      if (third != kNone)
        equations.AddRow<3>({node, second, third}, {1, -2, 1}, 0,
                            stiffness_at(height(node) - 2 * height(second) + height(third)));
    }
  for (const Patch& patch : patches_)
    equations.AddRow<4>(patch.nodes, {1, -1, -1, 1}, 0,
                        2 * stiffness_at(height(patch.nodes[0]) - height(patch.nodes[1]) -
                                         height(patch.nodes[2]) + height(patch.nodes[3])));
}

double HeightField::WeightOf(const HeightObservation& observation) const {
  double height = observation.point_in_site.z();
  FindPatch(observation.point_in_site, height);
  const double offset = (observation.point_in_site.z() - height) / kOutlierHeight;
  return observation.weight / ((1 + offset * offset) * (1 + offset * offset));
}

void HeightField::AddObservations(const std::vector<HeightObservation>& observations,
                                  const HeightField* weighed_by, NormalEquations& equations) {
  struct Part {
    int patch = kNone;
    double weight = 0;
  };
  std::vector<Eigen::Matrix4d> lefts(patches_.size(), Eigen::Matrix4d::Zero());
  std::vector<Eigen::Vector4d> rights(patches_.size(), Eigen::Vector4d::Zero());
  const std::vector<Part> parts = ParallelMap(observations.size(), [&](size_t i) {
    const HeightObservation& observation = observations[i];
    return Part{FindPatch(observation.point_in_site),
                weighed_by ? weighed_by->WeightOf(observation) : observation.weight};
  });
  for (size_t k = 0; k < observations.size(); ++k) {
    if (parts[k].patch == kNone) continue;
    const HeightObservation& observation = observations[k];
    const Eigen::Vector3d& point = observation.point_in_site;
    const auto i = static_cast<size_t>(parts[k].patch);
    Patch& patch = patches_[i];
    patch.sigma = std::min(patch.sigma, observation.Sigma());
    const Coefficients c = Bilinear(SquaresOf(point.x()) - patch.x, SquaresOf(point.y()) - patch.y);
    const Eigen::Map<const Eigen::Vector4d> row(c.data());
    lefts[i] += parts[k].weight * row * row.transpose();
    rights[i] += parts[k].weight * point.z() * row;
  }
  for (size_t i = 0; i < patches_.size(); ++i)
    equations.AddBlock(patches_[i].nodes, lefts[i], rights[i]);
}

int HeightField::FindPatch(const Eigen::Vector3d& point_in_site) const {
  double height = 0;
  return FindPatch(point_in_site, height);
}

int HeightField::FindPatch(const Eigen::Vector3d& point_in_site, double& height) const {
  const double x = SquaresOf(point_in_site.x()), y = SquaresOf(point_in_site.y());
  const int column = FastFloor(x), row = FastFloor(y);
  const double fx = x - column, fy = y - row;
  int nearest = kNone;
  double nearest_distance = options_.level_separation;
  for (int patch = patches_at_.First(column, row); patch != kNone;
       patch = patches_at_.Next(patch)) {
    const double here = Bilinear(corners_[static_cast<size_t>(patch)], fx, fy);
    const double distance = std::abs(here - point_in_site.z());
    if (distance < nearest_distance) nearest = patch, nearest_distance = distance, height = here;
  }
  return nearest;
}

double HeightField::HeightAt(int patch, const Eigen::Vector2d& point_in_site) const {
  const Patch& square = patches_[static_cast<size_t>(patch)];
  const double fx = SquaresOf(point_in_site.x()) - square.x,
               fy = SquaresOf(point_in_site.y()) - square.y;
  return Bilinear(corners_[static_cast<size_t>(patch)], fx, fy);
}

int PatchFinder::Find(const Eigen::Vector3d& point_in_site, double& height) {
  const double x = field_->SquaresOf(point_in_site.x()), y = field_->SquaresOf(point_in_site.y());
  const int column = FastFloor(x), row = FastFloor(y);
  if (column != column_ || row != row_) {
    const int first = field_->patches_at_.First(column, row);
    if (first != HeightField::kNone && field_->patches_at_.Next(first) != HeightField::kNone)
      return field_->FindPatch(point_in_site, height);
    column_ = column, row_ = row, patch_ = first;
    if (first != HeightField::kNone) corners_ = field_->corners_[static_cast<size_t>(first)];
  }
  if (patch_ == HeightField::kNone) return HeightField::kNone;
  const double here = Bilinear(corners_, x - column, y - row);
  if (std::abs(here - point_in_site.z()) >= field_->options_.level_separation)
    return HeightField::kNone;
  height = here;
  return patch_;
}

}  // namespace parkade
