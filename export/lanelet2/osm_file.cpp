#include "export/lanelet2/osm_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <pugixml.hpp>
#include <sstream>

#include "core/version.h"

namespace parkade {
namespace {

std::string Format(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void AppendTag(pugi::xml_node& element, const std::string& key, const std::string& value) {
  pugi::xml_node tag = element.append_child("tag");
  tag.append_attribute("k").set_value(key.c_str());
  tag.append_attribute("v").set_value(value.c_str());
}

/// An element with what editors of OSM ask for.
pugi::xml_node AppendElement(pugi::xml_node& parent, const char* name, std::int64_t id) {
  pugi::xml_node element = parent.append_child(name);
  element.append_attribute("id").set_value(static_cast<long long>(id));
  element.append_attribute("visible").set_value("true");
  element.append_attribute("version").set_value("1");
  return element;
}

}  // namespace

bool OsmFile::AddLine(std::span<const Eigen::Vector3d> points, const OsmTags& tags) {
  const auto rounded = [](const Eigen::Vector3d& point) {
    return Eigen::Vector3d((1000 * point).array().round());
  };
  std::vector<Eigen::Vector3d> distinct;
  for (const Eigen::Vector3d& point : points)
    if (distinct.empty() || rounded(point) != rounded(distinct.back())) distinct.push_back(point);
  if (distinct.size() < 2) return false;
  std::vector<std::int64_t> nodes = NodesAt(distinct);
  ways_.push_back({++last_id_, std::move(nodes), tags});
  return true;
}

void OsmFile::AddPolygon(std::span<const Eigen::Vector3d> ring, const OsmTags& tags) {
  std::vector<std::int64_t> nodes = NodesAt(ring);
  std::reverse(nodes.begin(), nodes.end());
  ways_.push_back({++last_id_, std::move(nodes), tags});
  ways_.back().tags.emplace_back("area", "yes");
}

std::vector<std::int64_t> OsmFile::NodesAt(std::span<const Eigen::Vector3d> points) {
  std::vector<std::int64_t> nodes;
  nodes.reserve(points.size());
  for (const Eigen::Vector3d& point : points) nodes.push_back(NodeAt(point));
  return nodes;
}

std::int64_t OsmFile::NodeAt(const Eigen::Vector3d& point) {
  const Millimeters position = {std::llround(1000 * point.x()), std::llround(1000 * point.y()),
                                std::llround(1000 * point.z())};
  const auto [found, is_new] = id_at_.try_emplace(position, last_id_ + 1);
  if (is_new) nodes_.push_back({++last_id_, position});
  return found->second;
}

std::string OsmFile::Encode() const {
  pugi::xml_document document;
  pugi::xml_node osm = document.append_child("osm");
  osm.append_attribute("version").set_value("0.6");
  osm.append_attribute("generator").set_value("parkade");
  // Autoware refuses maps that do not say in which format they are.
  pugi::xml_node info = osm.append_child("MetaInfo");
  info.append_attribute("format_version").set_value("1");
  info.append_attribute("map_version").set_value(kVersion);
  for (const Node& node : nodes_) {
    const auto& [x, y, z] = node.position;
    const Eigen::Vector3d point =
        1e-3 *
        Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    const Geodetic geodetic = projector_.Unproject(point);
    pugi::xml_node element = AppendElement(osm, "node", node.id);
    element.append_attribute("lat").set_value(Format("%.11f", geodetic.latitude_deg).c_str());
    element.append_attribute("lon").set_value(Format("%.11f", geodetic.longitude_deg).c_str());
    AppendTag(element, "local_x", Format("%.3f", point.x()));
    AppendTag(element, "local_y", Format("%.3f", point.y()));
    AppendTag(element, "ele", Format("%.4f", geodetic.altitude));
  }
  for (const Way& way : ways_) {
    pugi::xml_node element = AppendElement(osm, "way", way.id);
    for (const std::int64_t node : way.nodes)
      element.append_child("nd").append_attribute("ref").set_value(static_cast<long long>(node));
    for (const auto& [key, value] : way.tags) AppendTag(element, key, value);
  }
  std::ostringstream text;
  document.save(text, " ");
  return std::move(text).str();
}

}  // namespace parkade
