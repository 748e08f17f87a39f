#pragma once

#include <string_view>

namespace parkade {

/// The bytes of mapping/models/freespace.onnx, which the build puts into the program, so that it runs from anywhere.
std::string_view BuiltinFreespaceNetwork();

}  // namespace parkade
