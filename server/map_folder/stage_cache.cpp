#include "server/map_folder/stage_cache.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <random>

#include "core/error.h"
#include "core/files/file.h"
#include "core/files/sha256.h"
#include "core/log.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

// A file is the magic and then any number of: key, SHA-256 of the result (64 hexadecimal digits
// each), size, result.
constexpr std::string_view kMagic = "parkade stages 1\n";
constexpr size_t kDigits = 64;
constexpr std::uint64_t kHeadBytes = kMagic.size() + 2 * kDigits + sizeof(std::uint64_t);
constexpr std::uint64_t kMaxBytes = std::uint64_t{16} << 30;
constexpr std::uint64_t kPieceBytes = std::uint64_t{1} << 16;  // stays in the processor's cache

/// Reads a file of results one by one.
class ProductReader {
 public:
  explicit ProductReader(const fs::path& file) : stream_(file, std::ios::binary) {
    std::string magic(kMagic.size(), ' ');
    is_good_ = stream_.read(magic.data(), std::ssize(magic)) && magic == kMagic;
    if (is_good_) file_size_ = fs::file_size(file);
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
  /// [B] of the result that Next came to.
  std::uint64_t size() const { return size_; }
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
    const auto begin = static_cast<std::uint64_t>(stream_.tellg());
    if (begin + size_ > file_size_) return std::nullopt;
    std::string result(size_, '\0');
    if (!stream_.read(result.data(), std::ssize(result))) return std::nullopt;
    Sha256 hash;
    hash.Add(result);
    return hash.Finish() == sum_ ? std::optional(std::move(result)) : std::nullopt;
  }

 private:
  std::ifstream stream_;
  std::uint64_t file_size_ = 0;
  bool is_good_ = false;
  std::string sum_;
  std::uint64_t size_ = 0;
};

/// Comes to the result under the key; says whether there is one.
bool FindKey(ProductReader& reader, const std::string& key) {
  while (const std::optional<std::string> found = reader.Next()) {
    if (*found == key) return true;
    reader.Skip();
  }
  return false;
}

void WarnOfDamage(const fs::path& file) {
  LogWarning("a result of an earlier build in '" + file.string() +
             "' is damaged; it is computed again");
}

/// Hands on the result under the key; says whether there is a whole one.
bool FindInFile(const fs::path& file, const std::string& key, const PieceSink& sink) {
  ProductReader reader(file);
  if (!FindKey(reader, key)) return false;
  if (reader.Read(sink)) return true;
  WarnOfDamage(file);
  return false;
}

struct Found {
  fs::path file;
  std::string result;
};

/// The result of the first folder that has a whole one.
std::optional<Found> FindResult(const std::vector<fs::path>& folders, const std::string& file,
                                const std::string& key) {
  for (const fs::path& folder : folders) {
    ProductReader reader(folder / file);
    if (!FindKey(reader, key)) continue;
    if (std::optional<std::string> result = reader.Read())
      return Found{folder / file, std::move(*result)};
    WarnOfDamage(folder / file);
  }
  return std::nullopt;
}

/// The last result of a file after its key; nothing where it is not whole.
std::optional<std::pair<std::string, std::string>> LastKeyed(const fs::path& file) {
  ProductReader reader(file);
  std::string last;
  std::optional<std::string> result;
  while (const std::optional<std::string> key = reader.Next()) {
    last = *key;
    result = reader.Read();
  }
  return result ? std::optional(std::pair(last, std::move(*result))) : std::nullopt;
}

/// Whether a file has one result and is as long as that says.
bool HoldsOneResult(const fs::path& file) {
  ProductReader reader(file);
  return reader.Next() && fs::file_size(file) == kHeadBytes + reader.size();
}

/// Makes a copy where an older map shares the file.
void StopSharing(const fs::path& file) {
  if (fs::hard_link_count(file) < 2) return;
  fs::path copy = file;
  copy += ".own";
  CopyToWrite(file, copy);
  fs::rename(copy, file);
}

void Append(const fs::path& file, const std::string& key,
            const std::function<void(const PieceSink&)>& write) {
  fs::create_directories(file.parent_path());
  const bool is_new = !fs::exists(file);
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
bool TakeOver(const fs::path& from, const fs::path& to) {
  if (fs::exists(to) || !HoldsOneResult(from)) return false;
  LinkOrCopy(from, to);
  return true;
}

}  // namespace

StageCache::StageCache(fs::path from, fs::path to, fs::path work)
    : from_(std::move(from)), to_(std::move(to)), work_(std::move(work)) {
  if (!from_.empty()) sources_.push_back(from_);
  if (!work_.empty()) sources_.push_back(work_);
}

bool StageCache::MapHas(const std::string& file, const std::string& key) const {
  if (from_.empty()) return false;
  ProductReader reader(from_ / file);
  return FindKey(reader, key);
}

std::optional<std::pair<std::string, std::string>> StageCache::LastOfMap(
    const std::string& file) const {
  return from_.empty() ? std::nullopt : LastKeyed(from_ / file);
}

std::optional<std::string> StageCache::Find(const std::string& file, const std::string& key) const {
  std::optional<Found> found = FindResult(sources_, file, key);
  return found ? std::optional(std::move(found->result)) : std::nullopt;
}

std::string StageCache::Get(const std::string& file, const std::string& key,
                            const std::function<std::string()>& compute) const {
  std::optional<Found> found = FindResult(sources_, file, key);
  if (found && !to_.empty() && TakeOver(found->file, to_ / file)) return found->result;
  std::string result = found ? std::move(found->result) : compute();
  if (to_.empty()) return result;
  Append(to_ / file, key, [&](const PieceSink& sink) { sink(result); });
  if (!found) Share(file);
  return result;
}

void StageCache::Keep(const std::string& file, const std::string& key,
                      const std::function<void(const PieceSink&)>& compute) const {
  if (to_.empty()) return;
  const auto source = std::find_if(sources_.begin(), sources_.end(), [&](const fs::path& folder) {
    return FindInFile(folder / file, key, [](std::string_view) {});
  });
  const bool is_there = source != sources_.end();
  if (is_there && TakeOver(*source / file, to_ / file)) return;
  Append(to_ / file, key, [&](const PieceSink& sink) {
    if (is_there)
      FindInFile(*source / file, key, sink);
    else
      compute(sink);
  });
  if (!is_there) Share(file);
}

bool StageCache::ShareUnread(const std::string& file, const std::string& key) const {
  return !to_.empty() && MapHas(file, key) && TakeOver(from_ / file, to_ / file);
}

std::string StageCache::ReadShared(const std::string& file, const std::string& key,
                                   const std::function<std::string()>& compute) const {
  std::optional<Found> found = FindResult(sources_, file, key);
  if (found && found->file == from_ / file) return std::move(found->result);
  std::string result = found ? std::move(found->result) : compute();
  fs::remove(to_ / file);
  Append(to_ / file, key, [&](const PieceSink& sink) { sink(result); });
  Share(file);
  return result;
}

void StageCache::Share(const std::string& file) const {
  if (!work_.empty()) LinkOrCopy(to_ / file, work_ / file);
}

std::optional<std::string> LastProduct(const fs::path& file) {
  auto last = LastKeyed(file);
  return last ? std::optional(std::move(last->second)) : std::nullopt;
}

void LinkOrCopy(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  // Another run of the job, on a machine that was given up, may be at the same file.
  fs::path next = to;
  next += ".next" + std::to_string(std::random_device()());
  std::error_code error;
  fs::create_hard_link(from, next, error);
  if (error) CopyToWrite(from, next);  // published files are read-only
  fs::rename(next, to);
  fs::remove(next);  // it is still there where both were one file
}

std::string KeyOf(const std::vector<std::string>& parts) {
  Sha256 hash;
  for (const std::string& part : parts) hash.Add(std::to_string(part.size()) + ":" + part);
  return hash.Finish();
}

}  // namespace parkade
