#include "server/map_folder/input_hash.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>

#include "core/error.h"
#include "core/files/sha256.h"
#include "server/ingest/files/merge_wal.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

InputHash HashFile(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  Require(!error && ::access(file.c_str(), R_OK) == 0, ErrorCode::kInvalidInput,
          "'" + file.string() +
              "' cannot be read: " + (error ? error.message() : std::strerror(errno)));
  return {file.filename().string(), static_cast<std::int64_t>(bytes), Sha256OfFile(file)};
}

/// The files of a folder by their names in it.
std::map<std::string, fs::path> FilesIn(const fs::path& folder, const fs::path& left_out) {
  constexpr auto kSkip = fs::directory_options::skip_permission_denied;
  std::map<std::string, fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, kSkip, error), end; !error && at != end;
       at.increment(error)) {
    std::error_code ignored;
    if (!left_out.empty() && fs::equivalent(at->path(), left_out, ignored))
      at.disable_recursion_pending();
    else if (at->is_regular_file(ignored))
      files[at->path().lexically_relative(folder).generic_string()] = at->path();
  }
  Require(!error, ErrorCode::kInvalidInput,
          "'" + folder.string() + "' cannot be read: " + error.message());
  return files;
}

/// Identifies several files by their names.
InputHash HashFiles(const std::string& name, const std::map<std::string, fs::path>& files) {
  InputHash result{name, 0, ""};
  Sha256 manifest;
  for (const auto& [file_name, file] : files) {
    const InputHash hash = HashFile(file);
    manifest.Add(hash.sha256 + " " + std::to_string(hash.bytes) + " " + file_name + "\n");
    result.bytes += hash.bytes;
  }
  result.sha256 = manifest.Finish();
  return result;
}

}  // namespace

InputHash HashInput(const fs::path& path, const fs::path& left_out) {
  const fs::path plain = path.has_filename() ? path : path.parent_path();  // "folder/"
  const std::string name = plain.filename().string();
  if (fs::is_directory(plain)) return HashFiles(name, FilesIn(plain, left_out));
  if (!HasWal(plain)) return HashFile(plain);
  const std::string wal = NameOfWal(plain);
  return HashFiles(name, {{name, plain}, {wal, plain.parent_path() / wal}});
}

}  // namespace parkade
