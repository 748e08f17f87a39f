#include "mapping/builtin_network.h"

// The assembler takes the file in as it is; CMake rebuilds this file when the network changes.
asm(R"(
  .section .rodata
  .balign 16
parkade_freespace_network:
  .incbin ")" PARKADE_FREESPACE_NETWORK R"("
parkade_freespace_network_end:
  .byte 0
  .text
)");

extern "C" {
extern const char parkade_freespace_network[];
extern const char parkade_freespace_network_end[];
}

namespace parkade {

std::string_view BuiltinFreespaceNetwork() {
  return {parkade_freespace_network,
          static_cast<std::size_t>(parkade_freespace_network_end - parkade_freespace_network)};
}

}  // namespace parkade
