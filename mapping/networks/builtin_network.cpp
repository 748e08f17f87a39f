#include "mapping/networks/builtin_network.h"

// The assembler takes the files in as they are; CMake rebuilds this file when a network changes.
#define PARKADE_TAKE_IN(name, file) \
  asm(".section .rodata\n"          \
      ".balign 16\n" name           \
      ":\n"                         \
      ".incbin \"" file "\"\n" name \
      "_end:\n"                     \
      ".byte 0\n"                   \
      ".text\n")

PARKADE_TAKE_IN("parkade_freespace_network", PARKADE_FREESPACE_NETWORK);
PARKADE_TAKE_IN("parkade_level_network", PARKADE_LEVEL_NETWORK);
PARKADE_TAKE_IN("parkade_outline_network", PARKADE_OUTLINE_NETWORK);

extern "C" {
extern const char parkade_freespace_network[];
extern const char parkade_freespace_network_end[];
extern const char parkade_level_network[];
extern const char parkade_level_network_end[];
extern const char parkade_outline_network[];
extern const char parkade_outline_network_end[];
}

namespace parkade {
namespace {

std::string_view Between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view BuiltinFreespaceNetwork() {
  return Between(parkade_freespace_network, parkade_freespace_network_end);
}

std::string_view BuiltinLevelNetwork() {
  return Between(parkade_level_network, parkade_level_network_end);
}

std::string_view BuiltinOutlineNetwork() {
  return Between(parkade_outline_network, parkade_outline_network_end);
}

}  // namespace parkade
