#pragma once

#include <filesystem>
#include <string>

namespace parkade {

/// The last line that one of our processes printed, without the program's name before it.
std::string LastSentence(const std::filesystem::path& log);

}  // namespace parkade
