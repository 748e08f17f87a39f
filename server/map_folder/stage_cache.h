#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace parkade {

/// Takes a result piece by piece.
using PieceSink = std::function<void(std::string_view piece)>;

/// Results of stages, kept in a map's folder under keys of all that they depend on, so that a later
/// build from that map need not find them again. A file holds any number of results.
class StageCache {
 public:
  /// \param from  finished map whose results may be taken; empty: none
  /// \param to    folder of the map in the making; empty: nothing is kept
  /// \param work  folder that outlives a build that does not finish: what is in `to` is there as
  ///              well, and may be taken by the next try; empty: none
  StageCache(std::filesystem::path from, std::filesystem::path to, std::filesystem::path work = {});

  /// The folders that results may be taken from, the first one first.
  const std::vector<std::filesystem::path>& sources() const { return sources_; }

  /// Whether the map to start from has a result under `key`; what an unfinished build left in
  /// `work` does not count.
  bool MapHas(const std::string& file, const std::string& key) const;

  /// The last result of a file of the map to start from, and its key; nothing where there is no
  /// whole one.
  std::optional<std::pair<std::string, std::string>> LastOfMap(const std::string& file) const;

  /// The result under `key` that is there; nothing where there is no whole one.
  std::optional<std::string> Find(const std::string& file, const std::string& key) const;

  /// The result under `key`: taken where there is a whole one, else computed. It is kept in the new
  /// map either way; a file with this one result is shared between the maps. `file` is relative to
  /// the maps' folders.
  std::string Get(const std::string& file, const std::string& key,
                  const std::function<std::string()>& compute) const;

  /// Does what Get does for results that are long and not needed now: they are only kept, piece by
  /// piece.
  void Keep(const std::string& file, const std::string& key,
            const std::function<void(const PieceSink&)>& compute) const;

  /// Shares a file of the map to start from with the new map, unread, where it holds this one
  /// result; says whether it does. What it holds is read by ReadShared.
  bool ShareUnread(const std::string& file, const std::string& key) const;

  /// The result of a file that is shared. Where it is damaged, it is computed, and the new map has
  /// that.
  std::string ReadShared(const std::string& file, const std::string& key,
                         const std::function<std::string()>& compute) const;

  /// Puts a file of the map in the making, which is whole, into `work` as well.
  void Share(const std::string& file) const;

 private:
  std::vector<std::filesystem::path> sources_;
  std::filesystem::path from_, to_, work_;
};

/// The last result in a file of a finished map, whatever its key; nothing where there is no whole
/// one.
std::optional<std::string> LastProduct(const std::filesystem::path& file);

/// Links the file `from` under the name `to`, or copies it where the file system has no hard links.
/// Whoever reads `to` finds the old file or the new one.
void LinkOrCopy(const std::filesystem::path& from, const std::filesystem::path& to);

/// One key for all these values, in their order.
std::string KeyOf(const std::vector<std::string>& parts);

}  // namespace parkade
