#include "server/ingest/files/temporary_folder.h"

#include <cstdlib>

#include "core/error.h"

namespace parkade {

TemporaryFolder::TemporaryFolder(const std::filesystem::path& parent) {
  std::error_code error;
  const std::filesystem::path folder =
      parent.empty() ? std::filesystem::temp_directory_path(error) : parent;
  std::string name = (folder / "parkade_XXXXXX").string();
  Require(!error && mkdtemp(name.data()) != nullptr, ErrorCode::kInternal,
          "cannot make a temporary folder in " + folder.string());
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;  // nothing to be done about it here
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace parkade
