#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace parkade {

/// JSON that somebody else wrote. Discarded (nlohmann::json::is_discarded) where it is none, or is
/// nested more than 64 deep: trees are copied, written and searched by recursion, which a stack
/// must bear.
nlohmann::json ParseForeignJson(std::string_view text);

}  // namespace parkade
