#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/files/appended_file.h"
#include "core/files/binary_archive.h"

namespace parkade {

/// Records that are added one after the other and lie on disk, so that there may be more of them
/// than memory holds: of each, only where it lies is in memory. Any of them is read at any time;
/// several threads may read at once, while none adds. Needs Serialize(archive, record).
template <typename Record>
class RecordStore {
 public:
  void Add(Record& record) {
    BinaryWriter writer;
    writer(record);
    offsets_.push_back(file_.size());
    file_.Append(writer.bytes());
  }

  /// The record's bytes, as Add encoded them.
  std::string Bytes(std::size_t i) const {
    const std::uint64_t end = i + 1 < offsets_.size() ? offsets_[i + 1] : file_.size();
    return file_.Read(offsets_[i], end - offsets_[i]);
  }

  Record operator[](std::size_t i) const {
    const std::string bytes = Bytes(i);
    BinaryReader reader(bytes);
    Record record;
    reader(record);
    return record;
  }

  std::size_t size() const { return offsets_.size(); }

 private:
  AppendedFile file_;
  std::vector<std::uint64_t> offsets_;
};

}  // namespace parkade
