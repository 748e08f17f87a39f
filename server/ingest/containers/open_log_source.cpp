#include "server/ingest/containers/open_log_source.h"

#include "core/error.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/folder_source.h"
#include "server/ingest/containers/kept_source.h"
#include "server/ingest/containers/open_message_source.h"
#include "server/ingest/files/archive_extraction.h"

namespace parkade {

namespace fs = std::filesystem;

std::shared_ptr<const MessageSource> OpenLogSource(const fs::path& log,
                                                   const fs::path& scratch_folder) {
  const std::string name = log.filename().string();
  std::error_code error;
  Require(fs::exists(log, error), ErrorCode::kNotFound, "there is no log " + name);
  if (fs::is_directory(log)) {
    if (const auto drive = FindDriveFolder(log, name))
      return std::make_shared<FolderSource>(*drive);
    return OpenMessageSource(log, scratch_folder);
  }
  Require(fs::is_regular_file(log), ErrorCode::kInvalidInput,
          name + " is neither a file nor a folder");
  Require(fs::file_size(log) > 0, ErrorCode::kInvalidInput, name + " is empty");
  if (!IsArchive(log)) return OpenMessageSource(log, scratch_folder);
  auto folder = std::make_shared<const TemporaryFolder>(scratch_folder);
  const ExtractionResult result = ExtractArchive(log, folder->path());
  if (!result.log_folder)
    return std::make_shared<FolderSource>(std::move(folder), name, result.damage);
  DamageReport damage;
  AddArchiveDamage(damage, result.damage);
  return KeepUnpacked(OpenMessageSource(*result.log_folder, scratch_folder), std::move(folder),
                      damage);
}

}  // namespace parkade
