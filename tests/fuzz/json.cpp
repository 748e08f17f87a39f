#include <httplib.h>

#include <string>

#include "core/error.h"
#include "server/http/routes/json_body.h"

/// Reads bytes as the body of a request, and its members as each kind.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  const httplib::ContentReader body(
      [&](httplib::ContentReceiver receive) {
        return receive(reinterpret_cast<const char*>(data), size);
      },
      [](httplib::MultipartContentHeader, httplib::ContentReceiver) { return false; });
  try {
    const Json object = ReadObject(body, {"a", "b", "point"});
    for (const char* key : {"a", "b"})
      for (const auto& read : {+[](const Json&json, const char*name) { TextIn(json, name); },
                               +[](const Json&json, const char*name) { IntegerIn(json, name); },
                               +[](const Json&json, const char*name) { RealIn(json, name); },
                               +[](const Json&json, const char*name) { FlagIn(json, name); },
                               +[](const Json&json, const char*name) { TextsIn(json, name); }})
        try {
          read(object, key);
        } catch (const Error&) {  // of another kind
        }
    if (object.contains("point")) PointOf(object.at("point"));
  } catch (const Error&) {  // a clear refusal
  }
  return 0;
}
