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

/// Reads a file of results one by one.
class ProductReader {
 public:
  explicit ProductReader(const std::filesystem::path& file) : stream_(file, std::ios::binary) {
    std::string magic(kMagic.size(), ' ');
    is_good_ = stream_.read(magic.data(), std::ssize(magic)) && magic == kMagic;
  }

  /// The next result's key; nothing at the end. Then either Read or Skip.
  std::optional<std::string> Next() {
    std::string key(kDigits, ' ');
    sum_.assign(kDigits, ' ');
    if (!is_good_ || !stream_.read(key.data(), std::ssize(key)) || !stream_.read(sum_.data(), std::ssize(sum_)))
      return std::nullopt;
    stream_.read(reinterpret_cast<char*>(&size_), sizeof size_);
    if (!stream_ || size_ > kMaxBytes) return std::nullopt;
    return key;
  }
  void Skip() { stream_.seekg(static_cast<std::streamoff>(size_), std::ios::cur); }
  /// Nothing where it is not whole.
  std::optional<std::string> Read() {
    std::string result(size_, ' ');
    if (stream_.read(result.data(), std::ssize(result)) && Sha256Of(result) == sum_) return result;
    return std::nullopt;
  }

 private:
  std::ifstream stream_;
  bool is_good_ = false;
  std::string sum_;
  std::uint64_t size_ = 0;
};

std::optional<std::string> Find(const std::filesystem::path& file, const std::string& key) {
  ProductReader reader(file);
  while (const std::optional<std::string> found = reader.Next()) {
    if (*found != key) {
      reader.Skip();
      continue;
    }
    std::optional<std::string> result = reader.Read();
    if (!result) LogWarning("a result of an earlier build in '" + file.string() + "' is damaged; it is computed again");
    return result;
  }
  return std::nullopt;
}

bool HoldsOneResult(const std::filesystem::path& file) {
  ProductReader reader(file);
  if (!reader.Next()) return false;
  reader.Skip();
  return !reader.Next();
}

/// A copy of its own, where an older map shares the file.
void StopSharing(const std::filesystem::path& file) {
  if (std::filesystem::hard_link_count(file) < 2) return;
  std::filesystem::path copy = file;
  copy += ".own";
  std::filesystem::copy_file(file, copy);
  std::filesystem::rename(copy, file);
}

void Append(const std::filesystem::path& file, const std::string& key, const std::string& result) {
  std::filesystem::create_directories(file.parent_path());
  const bool is_new = !std::filesystem::exists(file);
  if (!is_new) StopSharing(file);
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
  if (result && !to_.empty() && !std::filesystem::exists(to_ / file) && HoldsOneResult(from_ / file)) {
    LinkOrCopy(from_ / file, to_ / file);
    return std::move(*result);
  }
  if (!result) result = compute();
  if (!to_.empty()) Append(to_ / file, key, *result);
  return std::move(*result);
}

std::optional<std::string> LastProduct(const std::filesystem::path& file) {
  ProductReader reader(file);
  std::optional<std::string> last;
  while (reader.Next()) last = reader.Read();
  return last;
}

void LinkOrCopy(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::filesystem::create_directories(to.parent_path());
  std::filesystem::remove(to);
  std::error_code error;
  std::filesystem::create_hard_link(from, to, error);
  if (error) std::filesystem::copy_file(from, to);
}

std::string KeyOf(const std::vector<std::string>& parts) {
  Sha256 hash;
  for (const std::string& part : parts) hash.Add(std::to_string(part.size()) + ":" + part);
  return hash.Finish();
}

}  // namespace parkade
