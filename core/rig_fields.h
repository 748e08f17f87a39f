#pragma once

#include "core/field_map.h"
#include "core/yaml_file.h"

namespace parkade {

/// Reads `fields` of a vehicle.yaml. Throws Error{kInvalidInput} naming a key that is unknown, or
/// the signals that a sensor lacks.
FieldMap ReadFieldMap(const YamlNode& fields);

/// Writes what ReadFieldMap reads, as key `fields`; nothing for an empty map.
void WriteFieldMap(YAML::Emitter& out, const FieldMap& map);

}  // namespace parkade
