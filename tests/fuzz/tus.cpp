#include <cstdlib>
#include <string>

#include "core/error.h"
#include "server/http/tus_fields.h"

/// Reads bytes as the fields of tus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  const std::string field(reinterpret_cast<const char*>(data), size);
  const auto try_to = [](const auto& read) {
    try {
      read();
    } catch (const Error&) {  // a clear refusal
    }
  };
  try_to([&] { ParseTusMetadata(field); });
  try_to([&] { ParseTusChecksum(field); });
  try_to([&] {
    if (ParseTusLength("Upload-Length", field) < 0) std::abort();
  });
  return 0;
}
