#include "server/map_folder/stage_cache.h"

#include <fstream>
#include <optional>

#include "core/error.h"
#include "core/file.h"
#include "core/log.h"
#include "core/sha256.h"

namespace parkade {
namespace {

// A file is the magic and then any number of: key, SHA-256 of the result (64 hexadecimal digits
// each), size, result.
constexpr std::string_view kMagic = "parkade stages 1\n";
constexpr size_t kDigits = 64;
constexpr std::uint64_t kMaxBytes = std::uint64_t{16} << 30;
constexpr std::uint64_t kPieceBytes = std::uint64_t{1} << 20;

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
    if (!is_good_ || !stream_.read(key.data(), std::ssize(key)) ||
        !stream_.read(sum_.data(), std::ssize(sum_)))
      return std::nullopt;
    stream_.read(reinterpret_cast<char*>(&size_), sizeof size_);
    if (!stream_ || size_ > kMaxBytes) return std::nullopt;
    return key;
  }
  void Skip() { stream_.seekg(static_cast<std::streamoff>(size_), std::ios::cur); }
  /// Hands on the result; whether it was whole shows only at its end.
  bool Read(const PieceSink& sink) {
    Sha256 hash;
    std::string piece;
    for (std::uint64_t left = size_; left > 0; left -= piece.size()) {
      piece.resize(std::min(left, kPieceBytes));
      if (!stream_.read(piece.data(), std::ssize(piece))) return false;
      hash.Add(piece);
      sink(piece);
    }
    return hash.Finish() == sum_;
  }
  /// The result; nothing where it is not whole.
  std::optional<std::string> Read() {
    std::string result;
    if (Read([&result](std::string_view piece) { result += piece; })) return result;
    return std::nullopt;
  }

 private:
  std::ifstream stream_;
  bool is_good_ = false;
  std::string sum_;
  std::uint64_t size_ = 0;
};

/// Hands on the result under the key; says whether there is a whole one.
bool FindInFile(const std::filesystem::path& file, const std::string& key, const PieceSink& sink) {
  ProductReader reader(file);
  while (const std::optional<std::string> found = reader.Next()) {
    if (*found != key) {
      reader.Skip();
      continue;
    }
    if (reader.Read(sink)) return true;
    LogWarning("a result of an earlier build in '" + file.string() +
               "' is damaged; it is computed again");
    return false;
  }
  return false;
}

bool HoldsOneResult(const std::filesystem::path& file) {
  ProductReader reader(file);
  if (!reader.Next()) return false;
  reader.Skip();
  return !reader.Next();
}

/// Makes a copy where an older map shares the file.
void StopSharing(const std::filesystem::path& file) {
  if (std::filesystem::hard_link_count(file) < 2) return;
  std::filesystem::path copy = file;
  copy += ".own";
  CopyToWrite(file, copy);
  std::filesystem::rename(copy, file);
}

void Append(const std::filesystem::path& file, const std::string& key,
            const std::function<void(const PieceSink&)>& write) {
  std::filesystem::create_directories(file.parent_path());
  const bool is_new = !std::filesystem::exists(file);
  if (!is_new) StopSharing(file);
  if (is_new) std::ofstream(file, std::ios::binary) << kMagic;
  std::ofstream stream(file, std::ios::binary | std::ios::in | std::ios::ate);
  stream << key;
  const std::ofstream::pos_type begin = stream.tellp();
  std::uint64_t size = 0;
  const auto write_head = [&](const std::string& sum) {
    stream << sum;
    stream.write(reinterpret_cast<const char*>(&size), sizeof size);
  };
  write_head(std::string(kDigits, '0'));  // placeholder until size and hash are known
  Sha256 hash;
  write([&](std::string_view piece) {
    hash.Add(piece);
    size += piece.size();
    stream << piece;
  });
  stream.seekp(begin);
  write_head(hash.Finish());
  stream.close();
  if (stream.fail()) ThrowCannotWrite(file);
}

/// The new map shares the whole file where it holds nothing else.
bool TakeOver(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::filesystem::exists(to) || !HoldsOneResult(from)) return false;
  LinkOrCopy(from, to);
  return true;
}

}  // namespace

StageCache::StageCache(std::filesystem::path from, std::filesystem::path to)
    : from_(std::move(from)), to_(std::move(to)) {}

std::optional<std::string> StageCache::Find(const std::string& file, const std::string& key) const {
  std::string result;
  const bool is_there =
      !from_.empty() &&
      FindInFile(from_ / file, key, [&](std::string_view piece) { result += piece; });
  return is_there ? std::optional(std::move(result)) : std::nullopt;
}

std::string StageCache::Get(const std::string& file, const std::string& key,
                            const std::function<std::string()>& compute) const {
  std::string result;
  const bool is_there =
      !from_.empty() &&
      FindInFile(from_ / file, key, [&result](std::string_view piece) { result += piece; });
  if (is_there && !to_.empty() && TakeOver(from_ / file, to_ / file)) return result;
  if (!is_there) result = compute();
  if (!to_.empty()) Append(to_ / file, key, [&](const PieceSink& sink) { sink(result); });
  return result;
}

void StageCache::Keep(const std::string& file, const std::string& key,
                      const std::function<void(const PieceSink&)>& compute) const {
  if (to_.empty()) return;
  const bool is_there = !from_.empty() && FindInFile(from_ / file, key, [](std::string_view) {});
  if (is_there && TakeOver(from_ / file, to_ / file)) return;
  Append(to_ / file, key, [&](const PieceSink& sink) {
    if (is_there)
      FindInFile(from_ / file, key, sink);
    else
      compute(sink);
  });
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
  if (error) CopyToWrite(from, to);  // published files are read-only
}

std::string KeyOf(const std::vector<std::string>& parts) {
  Sha256 hash;
  for (const std::string& part : parts) hash.Add(std::to_string(part.size()) + ":" + part);
  return hash.Finish();
}

}  // namespace parkade
