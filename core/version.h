#pragma once

namespace parkade {

/// The version of the program and of the maps that it writes.
inline constexpr char kVersion[] = "0.1.0";

}  // namespace parkade
