#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "server/ingest/containers/open_message_source.h"

// Reads bytes as a log: those that begin as FUZZ_BEGIN does, where that is defined.

#ifndef FUZZ_BEGIN
#define FUZZ_BEGIN ""
#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kBegin = sizeof(FUZZ_BEGIN) - 1;
  if (size < kBegin || std::memcmp(data, FUZZ_BEGIN, kBegin) != 0) return 0;
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("parkade-fuzz-" + std::to_string(::getpid()));
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const auto source = parkade::OpenMessageSource(file);
    const auto stream = source->Read(std::vector<bool>(source->topics().size(), true));
    while (stream->Next()) {
    }
  } catch (const parkade::Error&) {  // a clear refusal
  }
  return 0;
}
