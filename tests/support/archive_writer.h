#pragma once

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace parkade {

/// An entry of an archive as tests write them.
struct Entry {
  std::string path, content;
  mode_t type = AE_IFREG;
  std::string link = "";
};

/// `kind`: zip, tar, tar.gz or tar.zst.
inline void WriteArchive(const std::filesystem::path& file, const std::string& kind,
                         const std::vector<Entry>& entries) {
  archive* writer = archive_write_new();
  if (kind == "zip")
    archive_write_set_format_zip(writer);
  else
    archive_write_set_format_pax_restricted(writer);
  if (kind == "tar.gz") archive_write_add_filter_gzip(writer);
  if (kind == "tar.zst") archive_write_add_filter_zstd(writer);
  ASSERT_EQ(archive_write_open_filename(writer, file.c_str()), ARCHIVE_OK);
  for (const Entry& entry : entries) {
    archive_entry* header = archive_entry_new();
    archive_entry_set_pathname(header, entry.path.c_str());
    archive_entry_set_filetype(header, entry.type);
    archive_entry_set_perm(header, 0644);
    if (entry.type == AE_IFLNK)
      archive_entry_set_symlink(header, entry.link.c_str());
    else if (!entry.link.empty())
      archive_entry_set_hardlink(header, entry.link.c_str());
    archive_entry_set_size(header, static_cast<la_int64_t>(entry.content.size()));
    ASSERT_EQ(archive_write_header(writer, header), ARCHIVE_OK) << archive_error_string(writer);
    archive_write_data(writer, entry.content.data(), entry.content.size());
    archive_entry_free(header);
  }
  archive_write_free(writer);
}

inline std::string Slurp(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// All files below a folder, under `prefix`.
inline std::vector<Entry> EntriesOf(const std::filesystem::path& folder,
                                    const std::string& prefix) {
  std::vector<Entry> entries;
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder))
    if (file.is_regular_file())
      entries.push_back(
          {prefix + std::filesystem::relative(file.path(), folder).string(), Slurp(file.path())});
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.path < b.path; });
  return entries;
}

}  // namespace parkade
