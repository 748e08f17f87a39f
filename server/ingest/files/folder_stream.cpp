#include "server/ingest/files/folder_stream.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace parkade {

bool IsStampedImage(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return false;
  std::string extension(name.substr(dot + 1));
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool is_image = extension == "png" || extension == "jpg" || extension == "jpeg";
  return is_image && name[0] != '.' &&
         name.substr(0, dot).find_first_not_of("0123456789.") == std::string_view::npos;
}

std::vector<std::string> StampedImages(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (std::string name = entry->path().filename().string(); IsStampedImage(name))
      names.push_back(std::move(name));
  return names;
}

StampUnit UnitOfNames(const std::filesystem::path& images) {
  std::vector<std::string> stamps;
  for (const std::string& name : StampedImages(images))
    stamps.push_back(name.substr(0, name.rfind('.')));
  // In the order of their numbers, as far as they are written alike.
  const auto num_whole_digits = [](const std::string& stamp) {
    return std::min(stamp.find('.'), stamp.size());
  };
  std::sort(stamps.begin(), stamps.end(), [&](const std::string& a, const std::string& b) {
    return std::pair(num_whole_digits(a), a) < std::pair(num_whole_digits(b), b);
  });
  return UnitOf(stamps, TableKind::kImages);
}

}  // namespace parkade
