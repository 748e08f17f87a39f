#include <cstdlib>
#include <string>

#include "server/http/byte_range.h"
#include "server/http/problem.h"

/// Reads bytes as a Range field of files of several sizes: what it gives lies within the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  const std::string field(reinterpret_cast<const char*>(data), size);
  for (const std::int64_t bytes : {std::int64_t{0}, std::int64_t{1000}, INT64_MAX}) try {
      const auto range = ParseByteRange(field, bytes);
      if (range && (range->first < 0 || range->length < 1 || range->length > bytes - range->first))
        std::abort();
    } catch (const HttpError&) {  // a clear refusal
    }
  return 0;
}
