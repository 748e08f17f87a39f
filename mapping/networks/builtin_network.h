#pragma once

#include <string_view>

namespace parkade {

/// The bytes of models/freespace.onnx, which the build puts into the program, so that it runs from
/// anywhere.
std::string_view BuiltinFreespaceNetwork();

/// Also of models/level.onnx.
std::string_view BuiltinLevelNetwork();

/// Also of models/outlines.onnx.
std::string_view BuiltinOutlineNetwork();

}  // namespace parkade
