#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/ingest/files/input_file.h"

namespace parkade {

/// Reads the remains of a damaged rosbag2 database: the rows that lie on its leaf pages, whatever
/// became of the pages that led to them (sqlite.org/fileformat2.html). Pages are taken in the order
/// of the file, which is about that of writing.
class SqlitePages {
 public:
  struct Topic {
    std::string name, type, encoding;
  };
  struct Row {
    std::int64_t id = 0, topic_id = 0, timestamp = 0;
    std::optional<std::vector<std::uint8_t>> data;  ///< nothing where its pages are missing
  };

  explicit SqlitePages(std::shared_ptr<const InputFile> file);

  /// Rows of the table of topics, by id.
  std::map<std::int64_t, Topic> FindTopics();

  /// The next row of the table of messages. Its data are only read for wanted topics.
  std::optional<Row> Next(const std::function<bool(std::int64_t topic_id)>& wants);

 private:
  struct Cell {
    std::int64_t row_id = 0;
    std::uint64_t size = 0;               ///< [byte] of the payload
    std::span<const std::uint8_t> local;  ///< the part of it on the page
    std::uint32_t overflow_page = 0;      ///< 0: none
  };

  bool LoadLeaf(std::uint64_t page);
  std::optional<Cell> CellAt(std::size_t index) const;
  std::optional<Row> ParseMessage(const Cell& cell,
                                  const std::function<bool(std::int64_t)>& wants) const;
  std::optional<std::vector<std::uint8_t>> ReadPayload(const Cell& cell) const;

  std::shared_ptr<const InputFile> file_;
  std::uint32_t page_size_ = 4096;
  std::uint32_t usable_size_ = 4096;
  std::uint64_t num_pages_ = 0;
  std::vector<std::uint8_t> page_;
  std::size_t page_header_ = 0;  ///< offset in page_
  std::size_t num_cells_ = 0;
  std::uint64_t next_page_ = 0;
  std::size_t next_cell_ = 0;
};

}  // namespace parkade
