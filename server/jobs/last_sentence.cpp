#include "server/jobs/last_sentence.h"

#include <sstream>

#include "core/error.h"
#include "server/store/disk/workers_files.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

std::string ContentOf(const std::filesystem::path& log) {
  try {
    return ReadWorkersFile(log, kMaxBytes);
  } catch (const Error&) {
    return "";
  }
}

}  // namespace

std::string LastSentence(const std::filesystem::path& log) {
  std::istringstream stream(ContentOf(log));
  std::string line, last;
  while (std::getline(stream, line))
    if (!line.empty()) last = line;
  const std::string name = "parkade: ";
  return last.starts_with(name) ? last.substr(name.size()) : last;
}

}  // namespace parkade
