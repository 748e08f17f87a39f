#include "core/calibration/rig_fields.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

using Names = std::vector<std::string>;

std::string Join(const Names& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list.append(i == 0 ? "" : i + 1 < names.size() ? ", " : " and ").append(names[i]);
  return list;
}

bool Contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void RequireKnown(const YamlNode& node, const std::string& key, const Names& known) {
  Require(Contains(known, key), ErrorCode::kInvalidInput,
          node.where() + " has an unknown key '" + key + "': known are " + Join(known));
}

FieldSignal ReadSignal(const YamlNode& node, const std::string& topic) {
  FieldSignal signal{topic, ""};
  if (node.IsMap()) {
    for (const std::string& key : node.Keys())
      RequireKnown(node, key, {"topic", "path", "scale", "offset"});
    signal.path = node.At("path").Text();
    if (node.Has("topic")) signal.topic = node.At("topic").Text();
    if (node.Has("scale")) signal.scale = node.At("scale").Number();
    if (node.Has("offset")) signal.offset = node.At("offset").Number();
  } else {
    signal.path = node.Text();
  }
  Require(!signal.topic.empty(), ErrorCode::kInvalidInput, node.where() + " has no 'topic'");
  return signal;
}

/// \param settings  keys that are no signals
FieldSignals ReadSignals(const YamlNode& node, Names known, const Names& settings) {
  known.push_back("stamp");
  Names allowed = known;
  allowed.push_back("topic");
  allowed.insert(allowed.end(), settings.begin(), settings.end());
  const std::string topic = node.Has("topic") ? node.At("topic").Text() : "";
  FieldSignals signals;
  for (const std::string& key : node.Keys()) {
    RequireKnown(node, key, allowed);
    if (Contains(known, key)) signals[key] = ReadSignal(node.At(key), topic);
  }
  return signals;
}

/// Whether all signals of one of the sets are there.
void RequireOneOf(const YamlNode& node, const FieldSignals& signals,
                  const std::vector<Names>& sets) {
  std::string wanted;
  for (const Names& set : sets) {
    if (std::all_of(set.begin(), set.end(),
                    [&](const std::string& name) { return signals.contains(name); }))
      return;
    wanted.append(wanted.empty() ? "" : "; or ").append(Join(set));
  }
  throw Error(ErrorCode::kInvalidInput, node.where() + " needs " + wanted);
}

void WriteSignals(YAML::Emitter& out, const char* sensor, const FieldSignals& signals,
                  double meters_per_tick) {
  if (signals.empty()) return;
  out << YAML::Key << sensor << YAML::Value << YAML::BeginMap;
  for (const auto& [name, signal] : signals) {
    out << YAML::Key << name << YAML::Value << YAML::Flow << YAML::BeginMap;
    out << YAML::Key << "topic" << YAML::Value << YAML::DoubleQuoted << signal.topic;
    out << YAML::Key << "path" << YAML::Value << YAML::DoubleQuoted << signal.path;
    out << YAML::Key << "scale" << YAML::Value << signal.scale;
    out << YAML::Key << "offset" << YAML::Value << signal.offset << YAML::EndMap;
  }
  if (meters_per_tick != 0) out << YAML::Key << "meters_per_tick" << YAML::Value << meters_per_tick;
  out << YAML::EndMap;
}

}  // namespace

FieldMap ReadFieldMap(const YamlNode& fields) {
  FieldMap map;
  for (const std::string& key : fields.Keys()) RequireKnown(fields, key, {"imu", "wheels", "gnss"});
  if (fields.Has("imu")) {
    const Names six = {"rate_x",         "rate_y",         "rate_z",
                       "acceleration_x", "acceleration_y", "acceleration_z"};
    map.imu = ReadSignals(fields.At("imu"), six, {});
    RequireOneOf(fields.At("imu"), map.imu, {six});
  }
  if (fields.Has("wheels")) {
    const YamlNode node = fields.At("wheels");
    map.wheels = ReadSignals(node,
                             {"speed", "yaw_rate", "steering_angle", "speed_left", "speed_right",
                              "ticks_left", "ticks_right"},
                             {"meters_per_tick"});
    RequireOneOf(node, map.wheels,
                 {{"speed", "yaw_rate"},
                  {"speed", "steering_angle"},
                  {"speed_left", "speed_right"},
                  {"ticks_left", "ticks_right"}});
    if (map.wheels.contains("ticks_left"))
      map.meters_per_tick = node.At("meters_per_tick").Number();
  }
  if (fields.Has("gnss")) {
    map.gnss = ReadSignals(
        fields.At("gnss"),
        {"latitude", "longitude", "altitude", "sigma_horizontal", "sigma_vertical"}, {});
    RequireOneOf(fields.At("gnss"), map.gnss, {{"latitude", "longitude"}});
  }
  return map;
}

void WriteFieldMap(YAML::Emitter& out, const FieldMap& map) {
  if (map.IsEmpty()) return;
  out << YAML::Key << "fields" << YAML::Value << YAML::BeginMap;
  WriteSignals(out, "imu", map.imu, 0);
  WriteSignals(out, "wheels", map.wheels, map.meters_per_tick);
  WriteSignals(out, "gnss", map.gnss, 0);
  out << YAML::EndMap;
}

}  // namespace parkade
