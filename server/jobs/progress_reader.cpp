#include "server/jobs/progress_reader.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/files/foreign_json.h"
#include "server/store/disk/workers_files.h"

namespace parkade {
namespace {

constexpr size_t kMaxLineBytes = size_t{1} << 20;  // a sentence may quote much
constexpr size_t kMaxTextBytes = 1024;
constexpr int kMaxPieces = 64;

/// A worker's text as it is shown to people: cut, and printable.
std::string Printable(const std::string& text) {
  std::string printable = text.substr(0, kMaxTextBytes);
  std::replace_if(
      printable.begin(), printable.end(),
      [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7f;
      },
      ' ');
  return printable;
}

std::optional<double> NumberAt(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number() || !std::isfinite(found->get<double>()))
    return std::nullopt;
  return found->get<double>();
}

std::optional<std::string> TextAt(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return std::nullopt;
  return Printable(found->get<std::string>());
}

}  // namespace

bool ProgressReader::Poll() {
  const FileHandle file = OpenWorkersFile(file_);
  if (!file.is_open()) return false;
  bool has_changed = false;
  std::array<char, 65536> piece;
  // No more in one go: a worker that talks without end has nobody's ear.
  for (int i = 0; i < kMaxPieces; ++i) {
    const ssize_t count = ::pread(file.fd(), piece.data(), piece.size(), offset_);
    if (count <= 0) break;
    offset_ += count;
    for (const char c : std::string_view(piece.data(), static_cast<size_t>(count))) {
      if (c != '\n') {
        if (partial_line_.size() < kMaxLineBytes) partial_line_ += c;
        continue;
      }
      has_changed |= Take(partial_line_);
      partial_line_.clear();
    }
  }
  return has_changed;
}

bool ProgressReader::Take(const std::string& line) {
  const nlohmann::json json = ParseForeignJson(line);
  if (!json.is_object()) return false;
  if (const auto stage = TextAt(json, "stage")) latest_.stage = *stage;
  if (const auto error = TextAt(json, "error")) latest_.error = *error;
  if (const auto code = TextAt(json, "code")) latest_.code = *code;
  if (const auto progress = NumberAt(json, "progress"))
    latest_.progress = std::max(latest_.progress, std::clamp(*progress, 0.0, 1.0));
  latest_.eta = NumberAt(json, "eta");
  return true;
}

}  // namespace parkade
