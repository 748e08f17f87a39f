#pragma once

#include <string_view>

namespace parkade {

/// The bytes of mapping/models/freespace.onnx, which the build puts into the program, so that it runs from anywhere.
std::string_view BuiltinFreespaceNetwork();

/// Likewise of mapping/models/level.onnx.
std::string_view BuiltinLevelNetwork();

/// Likewise of mapping/models/outlines.onnx.
std::string_view BuiltinOutlineNetwork();

}  // namespace parkade
