#include <archive.h>
#include <archive_entry.h>

#include <memory>

#include "core/error.h"
#include "server/store/rig_store.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

constexpr size_t kMaxFiles = 64;

struct FreeArchive {
  void operator()(archive* pointer) const { archive_free(pointer); }
};
using ArchivePointer = std::unique_ptr<archive, FreeArchive>;

std::string ContentOf(archive* reader, const std::string& name, size_t budget) {
  std::string content;
  std::array<char, 65536> piece{};
  for (;;) {
    const la_ssize_t size = archive_read_data(reader, piece.data(), piece.size());
    Require(size >= 0, ErrorCode::kInvalidInput, "'" + name + "' in the zip is damaged");
    if (size == 0) return content;
    content.append(piece.data(), static_cast<size_t>(size));
    Require(content.size() <= budget, ErrorCode::kInvalidInput,
            "the zip unpacks to more than 4 MiB");
  }
}

}  // namespace

RigFiles UnpackRig(const std::string& zip) {
  const ArchivePointer reader(archive_read_new());
  archive_read_support_format_zip(reader.get());
  Require(archive_read_open_memory(reader.get(), zip.data(), zip.size()) == ARCHIVE_OK,
          ErrorCode::kInvalidInput, "the rig is not a zip archive");

  RigFiles files;
  size_t total = 0;
  archive_entry* entry = nullptr;
  for (int result; (result = archive_read_next_header(reader.get(), &entry)) != ARCHIVE_EOF;) {
    Require(result == ARCHIVE_OK || result == ARCHIVE_WARN, ErrorCode::kInvalidInput,
            "the rig is not a zip archive, or it is damaged");
    if (archive_entry_filetype(entry) == AE_IFDIR) continue;
    const char* path = archive_entry_pathname(entry);
    const std::filesystem::path parts = path == nullptr ? "" : path;
    const std::string name = parts.filename().string();
    const bool is_plain = archive_entry_filetype(entry) == AE_IFREG && IsPlainName(name) &&
                          parts.is_relative() && std::distance(parts.begin(), parts.end()) <= 2 &&
                          *parts.begin() != "..";
    Require(is_plain, ErrorCode::kInvalidInput,
            "the zip may hold plain files in at most one folder, nothing else");
    Require(files.size() < kMaxFiles, ErrorCode::kInvalidInput, "the zip holds more than 64 files");
    Require(!files.contains(name), ErrorCode::kInvalidInput, "the zip holds '" + name + "' twice");
    files[name] = ContentOf(reader.get(), name, kMaxRigBytes - total);
    total += files[name].size();
  }
  return files;
}

std::string PackRig(const RigFiles& files) {
  size_t capacity = 4096;
  for (const auto& [name, content] : files) capacity += content.size() + 2 * name.size() + 512;
  std::string zip(capacity, '\0');
  size_t used = 0;

  const ArchivePointer writer(archive_write_new());
  archive_write_set_format_zip(writer.get());
  archive_write_set_options(writer.get(), "zip:compression=store");
  archive_write_set_bytes_per_block(writer.get(), 1);
  int result = archive_write_open_memory(writer.get(), zip.data(), zip.size(), &used);
  for (const auto& [name, content] : files) {
    const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                         archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), 315532800, 0);  // 1980-01-01, the oldest a zip knows
    result = std::min(result, archive_write_header(writer.get(), entry.get()));
    if (archive_write_data(writer.get(), content.data(), content.size()) !=
        static_cast<la_ssize_t>(content.size()))
      result = ARCHIVE_FATAL;
  }
  result = std::min(result, archive_write_close(writer.get()));
  Require(result == ARCHIVE_OK, ErrorCode::kInternal, "the rig cannot be packed");
  zip.resize(used);
  return zip;
}

}  // namespace parkade
