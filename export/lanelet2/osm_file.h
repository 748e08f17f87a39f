#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/geo.h"
#include "export/map_projector.h"

namespace parkade {

using OsmTags = std::vector<std::pair<std::string, std::string>>;

/// A map of Lanelet2 in the making: OSM XML 0.6 whose nodes have Autoware's tags `local_x`,
/// `local_y` and `ele`, to the millimeter. Ids count from 1, over nodes and ways alike, in the
/// order in which they are added: the same calls give the same bytes.
class OsmFile {
 public:
  /// `datum`: see MapProjector.
  explicit OsmFile(const std::optional<SiteDatum>& datum) : projector_(datum) {}

  /// Adds an open line [m] in site. Points that equal the one before are left out; returns false,
  /// and adds nothing, where fewer than two are left. Ways share nodes where they meet.
  bool AddLine(std::span<const Eigen::Vector3d> points, const OsmTags& tags);

  /// Adds a polygon by its counter-clockwise ring [m] in site; `area=yes` is added. It is written
  /// clockwise and not closed, as Lanelet2 has them.
  void AddPolygon(std::span<const Eigen::Vector3d> ring, const OsmTags& tags);

  std::string Encode() const;

 private:
  using Millimeters = std::array<std::int64_t, 3>;
  struct Node {
    std::int64_t id = 0;
    Millimeters position{};
  };
  struct Way {
    std::int64_t id = 0;
    std::vector<std::int64_t> nodes;
    OsmTags tags;
  };

  std::int64_t NodeAt(const Eigen::Vector3d& point);
  std::vector<std::int64_t> NodesAt(std::span<const Eigen::Vector3d> points);

  MapProjector projector_;
  std::int64_t last_id_ = 0;
  std::map<Millimeters, std::int64_t> id_at_;
  std::vector<Node> nodes_;
  std::vector<Way> ways_;
};

}  // namespace parkade
