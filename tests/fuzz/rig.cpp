#include "core/rig.h"

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "core/error.h"

/// Reads bytes as a rig, all in one file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("parkade-fuzz-" + std::to_string(::getpid()));
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    parkade::ReadCalibration(file);
  } catch (const parkade::Error&) {  // a clear refusal
  }
  return 0;
}
