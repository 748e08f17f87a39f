#include <Eigen/Eigenvalues>
#include <charconv>
#include <map>
#include <set>

#include "core/error.h"
#include "slam/pose_graph/g2o_file.h"

namespace parkade {
namespace {

constexpr double kLargestNumber = 1e12;       // beyond it, squares lose what matters
constexpr double kLargestInformation = 1e18;  // [1/m^2], [1/rad^2]

/// The words of one line, read one by one; every complaint names the line.
class LineReader {
 public:
  LineReader(std::string_view line, size_t number) : rest_(line), number_(number) {}

  /// Empty at the end of the line.
  std::string_view Word() {
    const size_t begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return rest_ = {};
    const size_t end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

  bool AtEnd() const { return rest_.find_first_not_of(" \t\r") == std::string_view::npos; }

  double Number(double largest = kLargestNumber) {
    const double number = Parse<double>("a number");
    if (!(std::abs(number) <= largest)) Fail("holds a number that is not finite or too large");
    return number;
  }

  std::int64_t Id() {
    const auto id = Parse<std::int64_t>("an id");
    if (id < 0) Fail("names a negative id");
    return id;
  }

  void ExpectEnd() const {
    if (!AtEnd()) Fail("holds more than belongs there");
  }

  [[noreturn]] void Fail(const std::string& complaint) const {
    throw Error(ErrorCode::kInvalidInput,
                "line " + std::to_string(number_) + " of the g2o file " + complaint);
  }

 private:
  template <typename T>
  T Parse(const char* what) {
    std::string_view word = Word();
    if (word.empty()) Fail(std::string("ends where ") + what + " was expected");
    if (word.front() == '+') word.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_underflow = std::is_floating_point_v<T> &&
                              error == std::errc::result_out_of_range &&
                              word.find("e-") != std::string_view::npos;
    if (is_underflow) return T{};
    if (error != std::errc{} || end != word.data() + word.size()) {
      Fail(std::string("holds a word that is not ") + what);
    }
    return value;
  }

  std::string_view rest_;
  size_t number_;
};

Rigid3 ReadPlanarPose(LineReader& line) {
  const double x = line.Number(), y = line.Number(), yaw = line.Number();
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, 0}};
}

Rigid3 ReadSpatialPose(LineReader& line) {
  Rigid3 pose;
  for (double& coordinate : pose.translation) coordinate = line.Number();
  for (double& coefficient : pose.rotation.coeffs()) coefficient = line.Number();
  if (std::abs(pose.rotation.norm() - 1) > 0.05)
    line.Fail("holds a quaternion that is not of unit length");
  pose.rotation.normalize();
  return pose;
}

/// The upper triangle, row by row, of the rows that `is_planar` leaves.
Matrix6d ReadInformation(LineReader& line, bool is_planar) {
  const std::vector<int> rows =
      is_planar ? std::vector<int>{0, 1, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
  Matrix6d information = Matrix6d::Zero();
  for (size_t i = 0; i < rows.size(); ++i)
    for (size_t j = i; j < rows.size(); ++j)
      information(rows[i], rows[j]) = information(rows[j], rows[i]) =
          line.Number(kLargestInformation);
  // Files print six digits: that much may be missing of a zero. Terms between translation and
  // rotation are not checked: the widely used `cubicle` has them in wrong places, and the chordal
  // objective does without.
  const auto is_semidefinite = [](const Eigen::Matrix3d& block) {
    const Eigen::Vector3d eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block, Eigen::EigenvaluesOnly).eigenvalues();
    return eigenvalues.minCoeff() >= -1e-6 * eigenvalues.maxCoeff();
  };
  if (!is_semidefinite(information.topLeftCorner<3, 3>()) ||
      !is_semidefinite(information.bottomRightCorner<3, 3>()))
    line.Fail("holds an information matrix that is not positive semidefinite");
  return information;
}

struct NamedEdge {
  std::int64_t from, to;
  LineReader line;  ///< to complain
  PoseGraphEdge edge;
};

/// What the lines say, before ids have become indices.
class G2oReader {
 public:
  void Read(LineReader line) {
    const std::string_view tag = line.Word();
    if (tag.empty() || tag.front() == '#') return;
    if (tag == "FIX") {
      do fixed_.emplace_back(line.Id(), line);
      while (!line.AtEnd());
      return;
    }
    const bool is_planar = tag == "VERTEX_SE2" || tag == "EDGE_SE2";
    if (!is_planar && tag != "VERTEX_SE3:QUAT" && tag != "EDGE_SE3:QUAT")
      line.Fail("is neither VERTEX_SE2, EDGE_SE2, VERTEX_SE3:QUAT, EDGE_SE3:QUAT nor FIX");
    if (!has_kind_) graph_.is_planar = is_planar;
    if (is_planar != graph_.is_planar) line.Fail("mixes SE2 and SE3 in one graph");
    has_kind_ = true;
    if (tag.front() == 'V') {
      ReadVertex(line);
    } else {
      ReadEdge(line);
    }
    line.ExpectEnd();
  }

  PoseGraph Finish() {
    Require(!edges_.empty(), ErrorCode::kInvalidInput, "the g2o file holds no edges");
    if (graph_.vertices.empty()) NameVerticesByEdges();
    for (NamedEdge& named : edges_) {
      named.edge.from = IndexOf(named.from, named.line);
      named.edge.to = IndexOf(named.to, named.line);
      graph_.edges.push_back(named.edge);
    }
    for (const auto& [id, line] : fixed_) graph_.vertices[IndexOf(id, line)].is_fixed = true;
    return std::move(graph_);
  }

 private:
  void ReadVertex(LineReader& line) {
    PoseGraphVertex vertex;
    vertex.id = line.Id();
    vertex.world_from_vertex = graph_.is_planar ? ReadPlanarPose(line) : ReadSpatialPose(line);
    if (!index_of_id_.emplace(vertex.id, graph_.vertices.size()).second)
      line.Fail("gives vertex " + std::to_string(vertex.id) + " a second time");
    graph_.vertices.push_back(vertex);
  }

  void ReadEdge(LineReader& line) {
    const std::int64_t from = line.Id(), to = line.Id();
    if (from == to) line.Fail("is an edge from vertex " + std::to_string(from) + " to itself");
    PoseGraphEdge edge;
    edge.from_from_to = graph_.is_planar ? ReadPlanarPose(line) : ReadSpatialPose(line);
    edge.information = ReadInformation(line, graph_.is_planar);
    edge.is_trusted = std::max(from, to) - std::min(from, to) == 1;
    edges_.push_back({from, to, line, edge});
  }

  void NameVerticesByEdges() {
    std::set<std::int64_t> ids;
    for (const NamedEdge& named : edges_) ids.insert({named.from, named.to});
    for (const std::int64_t id : ids) {
      index_of_id_.emplace(id, graph_.vertices.size());
      graph_.vertices.push_back({id, {}, false});
    }
  }

  size_t IndexOf(std::int64_t id, const LineReader& line) const {
    const auto found = index_of_id_.find(id);
    if (found == index_of_id_.end())
      line.Fail("names vertex " + std::to_string(id) + ", which the file does not give");
    return found->second;
  }

  PoseGraph graph_;
  bool has_kind_ = false;
  std::map<std::int64_t, size_t> index_of_id_;
  std::vector<NamedEdge> edges_;
  std::vector<std::pair<std::int64_t, LineReader>> fixed_;
};

}  // namespace

PoseGraph ReadG2o(std::string_view text) {
  G2oReader reader;
  for (size_t number = 1; !text.empty(); ++number) {
    const size_t end = std::min(text.find('\n'), text.size());
    reader.Read(LineReader(text.substr(0, end), number));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.Finish();
}

}  // namespace parkade
