#include "server/jobs/last_sentence.h"

#include <fstream>

namespace parkade {

std::string LastSentence(const std::filesystem::path& log) {
  std::ifstream stream(log);
  std::string line, last;
  while (std::getline(stream, line))
    if (!line.empty()) last = line;
  const std::string name = "parkade: ";
  return last.starts_with(name) ? last.substr(name.size()) : last;
}

}  // namespace parkade
