#include "server/store/uploads/tar_frame.h"

#include <archive.h>
#include <archive_entry.h>

#include <memory>

#include "core/error.h"
#include "server/store/disk/growing_file.h"

namespace parkade {
namespace {

constexpr std::int64_t kBlock = 512;
constexpr std::int64_t kEndBytes = 2 * kBlock;  // of zeros, which end a tar

struct FreeWriter {
  void operator()(archive* writer) const { archive_write_free(writer); }
};
struct FreeHeader {
  void operator()(archive_entry* entry) const { archive_entry_free(entry); }
};

struct Sink {
  std::string header;
  bool is_closed = false;
};

la_ssize_t AppendTo(archive*, void* sink, const void* bytes, size_t size) {
  Sink& to = *static_cast<Sink*>(sink);
  if (to.is_closed) return -1;
  to.header.append(static_cast<const char*>(bytes), size);
  return static_cast<la_ssize_t>(size);
}

/// All that a tar holds of a file before its content.
std::string HeaderOf(const TarFrame::File& file) {
  Sink sink;
  const std::unique_ptr<archive, FreeWriter> writer(archive_write_new());
  archive_write_set_format_pax_restricted(writer.get());
  archive_write_set_bytes_per_block(writer.get(), 0);  // hands on what it gets at once
  archive_write_open(writer.get(), &sink, nullptr, AppendTo, nullptr);
  const std::unique_ptr<archive_entry, FreeHeader> entry(archive_entry_new());
  archive_entry_set_pathname(entry.get(), file.path.c_str());
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_mtime(entry.get(), 0, 0);
  archive_entry_set_size(entry.get(), file.bytes);
  const int result = archive_write_header(writer.get(), entry.get());
  const bool is_written =
      result == ARCHIVE_OK && !sink.header.empty() && std::ssize(sink.header) % kBlock == 0;
  const char* error = archive_error_string(writer.get());
  Require(is_written, ErrorCode::kInternal,
          std::string("no tar can be made: ") + (error ? error : "no header"));
  sink.is_closed = true;  // it would write a content of zeros at its end
  return sink.header;
}

std::int64_t RoundedUp(std::int64_t bytes) { return (bytes + kBlock - 1) / kBlock * kBlock; }

}  // namespace

TarFrame::TarFrame(const std::vector<File>& files) {
  for (const File& file : files) {
    headers_.push_back(HeaderOf(file));
    first_bytes_.push_back(end_ + std::ssize(headers_.back()));
    end_ = RoundedUp(first_bytes_.back() + file.bytes);
  }
}

std::int64_t TarFrame::bytes() const { return end_ + kEndBytes; }

void TarFrame::Write(GrowingFile& file) const {
  for (size_t i = 0; i < headers_.size(); ++i) {
    file.Append(headers_[i]);
    const bool is_last = i + 1 == headers_.size();
    const std::int64_t next = is_last ? end_ : first_bytes_[i + 1] - std::ssize(headers_[i + 1]);
    file.Skip(next - file.size());
  }
  file.Append(std::string(kEndBytes, '\0'));
}

}  // namespace parkade
