#include <cstdlib>

#include "server/http/request_head.h"

/// Reads bytes as the head of a request. One that is taken reads the same in the words that the
/// HTTP library is given.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  try {
    const RequestHead head = ParseRequestHead({reinterpret_cast<const char*>(data), size});
    const std::int64_t length = CheckRequestHead(head);
    const RequestHead again = ParseRequestHead(ToText(head, length));
    if (length < 0 || again.method != head.method || again.target != head.target) std::abort();
  } catch (const HttpError&) {  // a clear refusal
  }
  return 0;
}
