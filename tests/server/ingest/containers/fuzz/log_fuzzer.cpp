#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "server/ingest/containers/open_message_source.h"

/// Reads any bytes as a log. Run it on a folder of small logs:
///   parkade_log_fuzzer -max_len=1000000 -timeout=10 -rss_limit_mb=1000 CORPUS
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
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
