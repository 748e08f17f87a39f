#include "server/ingest/containers/rosbag2_sqlite_source.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "server/ingest/containers/channel_clocks.h"
#include "server/ingest/containers/channel_table.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/log_record.h"
#include "server/ingest/containers/message_packing.h"
#include "server/ingest/containers/sqlite_pages.h"
#include "server/ingest/files/merge_wal.h"
#include "server/ingest/files/sqlite_database.h"
#include "server/ingest/files/temporary_folder.h"

namespace parkade {
namespace {

/// The state that all passes share.
struct Rosbag2File {
  std::unique_ptr<const TemporaryFolder> copy;  ///< holds the file where a log was merged into it
  std::filesystem::path path;
  std::shared_ptr<const InputFile> file;
  TopicMap topics;         ///< a topic's id is its channel
  std::string time_index;  ///< of the timestamp, by which rows are read; quoted; empty: by number
  TimeSpan span;           ///< empty where it is damaged
  DamageReport damage;
  bool is_damaged = false;  ///< found to be so when it was opened
};

/// The position of a message in the order of a pass.
using Rank = std::tuple<std::int64_t, std::int64_t>;

class SqliteStream : public MessageStream {
 public:
  SqliteStream(std::shared_ptr<const Rosbag2File> log, std::vector<bool> wanted)
      : log_(std::move(log)), wanted_(std::move(wanted)) {
    damage_ = OfWanted(log_->damage, log_->topics.topics, wanted_);
    if (log_->is_damaged) {
      TurnToPages("the database is damaged");
      return;
    }
    try {
      database_.emplace(log_->path);
      const std::string from =
          log_->time_index.empty()
              ? "messages ORDER BY id"
              : "messages INDEXED BY " + log_->time_index + " ORDER BY timestamp, id";
      query_.emplace(*database_, "SELECT id, topic_id, timestamp, length(data), data FROM " + from);
    } catch (const Error& error) {
      TurnToPages(error.what());
    }
  }

  std::optional<RawMessage> Next() override {
    while (!is_finished_) {
      std::optional<RawMessage> message = pages_ ? NextFromPages() : NextFromQuery();
      if (message && UnpackMessage(TopicOf(*message), *message, damage_)) return message;
    }
    return std::nullopt;
  }

  const DamageReport& damage() const override { return damage_; }

 private:
  std::optional<RawMessage> NextFromQuery() {
    try {
      while (query_->Step()) {
        const std::int64_t id = query_->Integer(0), time = query_->Integer(2);
        const std::optional<int> topic = WantedTopic(query_->Integer(1));
        std::optional<RawMessage> message;
        if (topic && query_->Integer(3) > static_cast<std::int64_t>(kMaxMessageSize)) {
          CountLoss("a message is larger than 64 MiB", *topic, time);
        } else if (topic) {
          const auto [bytes, size] = query_->Blob(4);
          message = RawMessage{*topic,
                               {std::max<std::int64_t>(time, 0)},
                               {bytes, bytes + size},
                               {static_cast<std::uint64_t>(id), 0}};
        }
        last_ = RankOf(id, time);
        if (message) return message;
      }
      is_finished_ = true;
    } catch (const Error& error) {
      TurnToPages(error.what());
    }
    return std::nullopt;
  }

  std::optional<RawMessage> NextFromPages() {
    const auto wants = [this](std::int64_t topic_id) { return WantedTopic(topic_id).has_value(); };
    while (auto row = pages_->Next(wants)) {
      largest_id_ = std::max(largest_id_, row->id);
      ++num_rows_;
      if (last_ && RankOf(row->id, row->timestamp) <= *last_)
        continue;  // the query gave it already
      const std::optional<int> topic = WantedTopic(row->topic_id);
      if (!topic) continue;
      if (row->data)
        return RawMessage{
            *topic, {std::max<std::int64_t>(row->timestamp, 0)}, std::move(*row->data)};
      CountLoss("pages of a message are missing", *topic, row->timestamp);
    }
    // rosbag2 counts ids up by one.
    constexpr std::int64_t kImplausible = std::int64_t{1} << 40;
    if (largest_id_ > num_rows_ && largest_id_ < kImplausible)
      AddLoss(damage_, {"pages of the database are damaged",
                        "",
                        {},
                        static_cast<std::uint64_t>(largest_id_ - num_rows_)});
    is_finished_ = true;
    return std::nullopt;
  }

  void TurnToPages(const std::string& reason) {
    AddLoss(damage_, {reason, "", {}, 0});
    query_.reset();
    database_.reset();
    pages_.emplace(log_->file);
  }

  Rank RankOf(std::int64_t id, std::int64_t time) const {
    return log_->time_index.empty() ? Rank{id, 0} : Rank{time, id};
  }

  std::optional<int> WantedTopic(std::int64_t topic_id) const {
    if (topic_id < 0 || topic_id > UINT32_MAX) return std::nullopt;
    const int topic = log_->topics.TopicOf(static_cast<std::uint32_t>(topic_id)).value_or(-1);
    return topic >= 0 && wanted_[static_cast<std::size_t>(topic)] ? std::optional(topic)
                                                                  : std::nullopt;
  }

  const TopicInfo& TopicOf(const RawMessage& message) const {
    return log_->topics.topics[static_cast<std::size_t>(message.topic)];
  }

  void CountLoss(const std::string& what, int topic, std::int64_t time) {
    const TimeSpan span{{time}, {time}};
    AddLoss(damage_, {what, log_->topics.topics[static_cast<std::size_t>(topic)].topic, span, 1});
  }

  std::shared_ptr<const Rosbag2File> log_;
  std::vector<bool> wanted_;
  DamageReport damage_;
  std::optional<SqliteDatabase> database_;
  std::optional<SqliteQuery> query_;
  std::optional<Rank> last_;  ///< of the message that the query gave last
  std::optional<SqlitePages> pages_;
  std::int64_t largest_id_ = 0, num_rows_ = 0;
  bool is_finished_ = false;
};

/// Only tables will do: a view could run for ever.
bool HasTables(const SqliteDatabase& database) {
  SqliteQuery query(
      database,
      "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('messages', 'topics')");
  return query.Step() && query.Integer(0) == 2;
}

std::string FindTimeIndex(const SqliteDatabase& database) {
  SqliteQuery query(
      database,
      "SELECT list.name FROM pragma_index_list('messages') AS list, pragma_index_info(list.name) "
      "AS info "
      "WHERE info.seqno = 0 AND info.name = 'timestamp' AND NOT list.partial LIMIT 1");
  if (!query.Step()) return "";
  std::string quoted = "\"";
  for (const char c : query.Text(0)) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::map<std::uint32_t, std::uint64_t> ReadTables(const SqliteDatabase& database,
                                                  ChannelTable& channels) {
  SqliteQuery topics(database, "SELECT id, name, type, serialization_format FROM topics");
  while (topics.Step())
    channels.AddChannel(static_cast<std::uint32_t>(topics.Integer(0)),
                        {topics.Text(1), topics.Text(2), topics.Text(3), std::nullopt});
  std::map<std::uint32_t, std::uint64_t> num_messages;
  SqliteQuery counts(database, "SELECT topic_id, count(*) FROM messages GROUP BY topic_id");
  while (counts.Step())
    num_messages[static_cast<std::uint32_t>(counts.Integer(0))] =
        static_cast<std::uint64_t>(counts.Integer(1));
  return num_messages;
}

/// Whether the recorder's clock was set back while it wrote: rows are numbered as they came.
/// Fills in the span of their times.
bool WasSetBack(const SqliteDatabase& database, TimeSpan& span) {
  ChannelClocks clocks;
  SqliteQuery rows(database, "SELECT topic_id, timestamp FROM messages ORDER BY id");
  while (rows.Step()) {
    const Timestamp time{std::max<std::int64_t>(rows.Integer(1), 0)};
    clocks.Add(static_cast<std::uint32_t>(rows.Integer(0)), time);
    span.Include(time);
  }
  return clocks.WereSetBack();
}

/// SQLite writes the number of pages into its header.
bool IsShorterThanItClaims(const InputFile& file) {
  std::array<std::uint8_t, 100> header{};
  if (file.ReadAt(0, header) < header.size()) return true;
  const auto number = [&](std::size_t offset, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | header[offset + i];
    return value;
  };
  const std::uint64_t page_size = number(16, 2) == 1 ? 65536 : number(16, 2);
  return number(28, 4) * page_size > file.size();
}

/// Whether whoever wrote the database did so by a write-ahead log.
bool IsInWalMode(const InputFile& file) {
  constexpr std::size_t kReadVersion = 19;
  std::array<std::uint8_t, kReadVersion + 1> header{};
  return file.ReadAt(0, header) == header.size() && header[kReadVersion] == 2;
}

class SqliteSource : public MessageSource {
 public:
  SqliteSource(const std::filesystem::path& path, const std::filesystem::path& scratch_folder)
      : log_(std::make_shared<Rosbag2File>()) {
    log_->path = path;
    if (HasWal(path)) ReadWithWal(scratch_folder);
    log_->file = std::make_shared<const InputFile>(log_->path);
    log_->damage.is_truncated = IsShorterThanItClaims(*log_->file);
    std::error_code error;
    const std::filesystem::path journal = path.string() + "-journal";
    if (std::filesystem::file_size(journal, error) > 0 && !error)
      AddLoss(log_->damage,
              {"'" + journal.filename().string() + "' beside it was not read", "", {}, 0});
    Scan();
  }

  const std::vector<TopicInfo>& topics() const override { return log_->topics.topics; }
  std::string format() const override { return "rosbag2 sqlite3"; }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<SqliteStream>(log_, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    try {
      const SqliteDatabase database(log_->path);
      SqliteQuery query(database,
                        "SELECT topic_id, timestamp, length(data), data FROM messages WHERE id = " +
                            std::to_string(static_cast<std::int64_t>(place.record)));
      if (!query.Step() || query.Integer(2) > static_cast<std::int64_t>(kMaxMessageSize))
        return std::nullopt;
      const std::int64_t id = query.Integer(0);
      const bool is_topic = id >= 0 && id <= UINT32_MAX;
      if (!is_topic || log_->topics.TopicOf(static_cast<std::uint32_t>(id)) != topic)
        return std::nullopt;
      const auto [bytes, size] = query.Blob(3);
      RawMessage message{
          topic, {std::max<std::int64_t>(query.Integer(1), 0)}, {bytes, bytes + size}, place};
      DamageReport damage;
      if (!UnpackMessage(topics()[static_cast<std::size_t>(topic)], message, damage))
        return std::nullopt;
      return message;
    } catch (const Error&) {
      return std::nullopt;  // the database is damaged there
    }
  }
  TimeSpan span() const override { return log_->is_damaged ? TimeSpan{} : log_->span; }

 private:
  void ReadWithWal(const std::filesystem::path& scratch_folder) {
    auto folder = std::make_unique<const TemporaryFolder>(scratch_folder);
    const std::filesystem::path copy = folder->path() / log_->path.filename();
    if (MergeWal(log_->path, copy)) {
      log_->path = copy;
      log_->copy = std::move(folder);
    } else {
      AddLoss(
          log_->damage,
          {"'" + NameOfWal(log_->path) + "' beside it holds nothing that can be used", "", {}, 0});
    }
  }

  /// Why a database has no tables of rosbag2.
  std::string SentenceWithoutTables() const {
    const std::string name = "'" + log_->file->name() + "'",
                      wal = "'" + NameOfWal(log_->path) + "'";
    if (!log_->damage.ranges.empty())
      return name + " holds no tables of rosbag2, and " + log_->damage.ranges.front().what;
    if (IsInWalMode(*log_->file))
      return name + " holds no tables of rosbag2: they may be in " + wal +
             ", which belongs beside it";
    return name + " is an SQLite database, but not one of rosbag2";
  }

  void Scan() {
    ChannelTable channels;
    std::map<std::uint32_t, std::uint64_t> num_messages;
    bool has_tables = true;
    try {
      const SqliteDatabase database(log_->path);
      has_tables = HasTables(database);
      if (has_tables) {
        log_->time_index = WasSetBack(database, log_->span) ? "" : FindTimeIndex(database);
        num_messages = ReadTables(database, channels);
      }
    } catch (const Error&) {
      log_->is_damaged = true;
      for (const auto& [id, topic] : SqlitePages(log_->file).FindTopics())
        if (std::in_range<std::uint32_t>(id))
          channels.AddChannel(static_cast<std::uint32_t>(id),
                              {topic.name, topic.type, topic.encoding, std::nullopt});
      has_tables = channels.num_channels() > 0;
    }
    Require(has_tables, ErrorCode::kInvalidInput, SentenceWithoutTables());
    log_->topics = channels.MakeTopics(num_messages);
  }

  std::shared_ptr<Rosbag2File> log_;
};

}  // namespace

std::unique_ptr<MessageSource> OpenRosbag2Sqlite(const std::filesystem::path& file,
                                                 const std::filesystem::path& scratch_folder) {
  return std::make_unique<SqliteSource>(file, scratch_folder);
}

}  // namespace parkade
