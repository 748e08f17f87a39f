#include "server/stage_products.h"

#include <fstream>
#include <optional>

#include "core/error.h"
#include "core/log.h"
#include "server/store/durable_file.h"

namespace parkade {
namespace {

// A file is the magic and then any number of: key, SHA-256 of the result (64 hexadecimal digits each), size, result.
constexpr std::string_view kMagic = "parkade stages 1\n";
constexpr size_t kDigits = 64;
constexpr std::uint64_t kMaxBytes = std::uint64_t{16} << 30;

std::optional<std::string> Find(const std::filesystem::path& file, const std::string& key) {
  std::ifstream stream(file, std::ios::binary);
  std::string magic(kMagic.size(), ' '), found(kDigits, ' '), sum(kDigits, ' ');
  if (!stream.read(magic.data(), std::ssize(magic)) || magic != kMagic) return std::nullopt;
  while (stream.read(found.data(), std::ssize(found)) && stream.read(sum.data(), std::ssize(sum))) {
    std::uint64_t size = 0;
    stream.read(reinterpret_cast<char*>(&size), sizeof size);
    if (!stream || size > kMaxBytes) return std::nullopt;
    if (found != key) {
      stream.seekg(static_cast<std::streamoff>(size), std::ios::cur);
      continue;
    }
    std::string result(size, ' ');
    if (stream.read(result.data(), std::ssize(result)) && Sha256Of(result) == sum) return result;
    LogWarning("a result of an earlier build in '" + file.string() + "' is damaged; it is computed again");
    return std::nullopt;
  }
  return std::nullopt;
}

void Append(const std::filesystem::path& file, const std::string& key, const std::string& result) {
  std::filesystem::create_directories(file.parent_path());
  const bool is_new = !std::filesystem::exists(file);
  std::ofstream stream(file, std::ios::binary | std::ios::app);
  if (is_new) stream << kMagic;
  const std::uint64_t size = result.size();
  stream << key << Sha256Of(result);
  stream.write(reinterpret_cast<const char*>(&size), sizeof size);
  stream << result;
  stream.close();
  Require(!stream.fail(), ErrorCode::kInternal, "cannot write '" + file.string() + "'");
}

}  // namespace

StageProducts::StageProducts(std::filesystem::path from, std::filesystem::path to)
    : from_(std::move(from)), to_(std::move(to)) {}

std::string StageProducts::Get(const std::string& file, const std::string& key,
                               const std::function<std::string()>& compute) const {
  std::optional<std::string> result;
  if (!from_.empty()) result = Find(from_ / file, key);
  if (!result) result = compute();
  if (!to_.empty()) Append(to_ / file, key, *result);
  return std::move(*result);
}

std::string KeyOf(const std::vector<std::string>& parts) {
  Sha256 hash;
  for (const std::string& part : parts) hash.Add(std::to_string(part.size()) + ":" + part);
  return hash.Finish();
}

}  // namespace parkade
