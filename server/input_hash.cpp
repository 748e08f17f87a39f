#include "server/input_hash.h"

#include <map>

#include "server/store/durable_file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

InputHash HashFile(const fs::path& file) {
  return {file.filename().string(), static_cast<std::int64_t>(fs::file_size(file)), Sha256OfFile(file)};
}

}  // namespace

InputHash HashInput(const fs::path& path) {
  const fs::path plain = path.has_filename() ? path : path.parent_path();  // "folder/"
  if (!fs::is_directory(plain)) return HashFile(plain);
  std::map<std::string, fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(plain))
    if (entry.is_regular_file()) files[entry.path().lexically_relative(plain).generic_string()] = entry.path();
  InputHash result{plain.filename().string(), 0, ""};
  Sha256 manifest;
  for (const auto& [name, file] : files) {
    const InputHash hash = HashFile(file);
    manifest.Add(hash.sha256 + " " + std::to_string(hash.bytes) + " " + name + "\n");
    result.bytes += hash.bytes;
  }
  result.sha256 = manifest.Finish();
  return result;
}

}  // namespace parkade
