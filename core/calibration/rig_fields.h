#pragma once

#include "core/calibration/yaml_file.h"
#include "core/field_map.h"

namespace parkade {

/// Reads `fields` of a vehicle.yaml. Throws Error{kInvalidInput} naming a key that is unknown, or
/// the signals that a sensor lacks.
FieldMap ReadFieldMap(const YamlNode& fields);

/// Writes what ReadFieldMap reads, as key `fields`; nothing for an empty map.
void WriteFieldMap(YAML::Emitter& out, const FieldMap& map);

}  // namespace parkade
