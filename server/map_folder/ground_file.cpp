#include "server/map_folder/ground_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "core/binary_serialization.h"
#include "core/error.h"
#include "core/files/file.h"
#include "core/log.h"

namespace parkade {

// Found by argument-dependent lookup, hence in the types' own namespace.
template <typename A>
void Serialize(A& archive, CompactPoint& point) {
  archive.Raw(&point, sizeof point);
}
template <typename A>
void Serialize(A& archive, CompactFloat& value) {
  archive.Raw(&value, sizeof value);
}
template <typename A>
void Serialize(A& archive, CameraPlacement& placement) {
  archive(placement.body_from_camera, placement.time_shift, placement.line_delay);
}
template <typename A>
void Serialize(A& archive, GroundCell& cell) {
  archive(cell.point_in_body, cell.weight, cell.footprint, cell.confidence);
}
template <typename A>
void Serialize(A& archive, StoredPatch& patch) {
  archive(patch.camera, patch.time, patch.num_samples, patch.offset, patch.size,
          patch.extent_in_body.min(), patch.extent_in_body.max());
}

namespace {

// A file is the magic, the key, the patches one after the other, the index, and last where the
// index is.
constexpr std::string_view kMagic = "parkade ground 4\n";
constexpr std::size_t kDigits = 64;
constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 26;  // of an image
constexpr std::uint64_t kMaxIndex = std::uint64_t{1} << 32;

struct Tail {
  std::uint64_t offset = 0, size = 0, unpacked_size = 0;  // of the index
};

struct Index {
  Rigid3 body_from_ground;
  int num_images = 0, num_masks = 0;
  std::vector<std::string> warnings;
  std::vector<CameraPlacement> placements;
  std::vector<std::vector<GroundCell>> cells;
  std::vector<StoredPatch> patches;
  std::string hash;  // of the patches, as they are in the file
};

template <typename A>
void Serialize(A& archive, Index& index) {
  archive(index.body_from_ground, index.num_images, index.num_masks, index.warnings,
          index.placements, index.cells, index.patches, index.hash);
}

}  // namespace

GroundFileWriter::GroundFileWriter(std::filesystem::path file, const std::string& key)
    : file_(std::move(file)), size_(kMagic.size() + kDigits) {
  Require(key.size() == kDigits, ErrorCode::kInternal, "a key has 64 digits");
  std::filesystem::create_directories(file_.parent_path());
  std::filesystem::remove(file_);  // never write into a file that an older map shares
  stream_.open(file_, std::ios::binary);
  stream_ << kMagic << key;
}

void GroundFileWriter::Add(const GroundPatch& patch) {
  const auto camera = static_cast<std::size_t>(patch.camera);
  if (camera >= cells_.size()) cells_.resize(camera + 1);
  const std::string bytes = EncodeSamples(patch.samples, cells_[camera]);
  patches_.push_back(
      {patch.camera, patch.time, patch.samples.size(), size_, bytes.size(), ExtentOf(patch)});
  stream_ << bytes;
  hash_.Add(bytes);
  size_ += bytes.size();
}

void GroundFileWriter::Finish(const GroundObservation& observation) {
  Index index{observation.body_from_ground,
              observation.num_images,
              observation.num_masks,
              observation.warnings,
              observation.placements,
              {},
              patches_,
              hash_.Finish()};
  for (const GroundCells& cells : cells_)
    index.cells.emplace_back(cells.cells().begin(), cells.cells().end());
  BinaryWriter writer;
  writer(index);
  const std::string bytes = Compress(writer.bytes());
  const Tail tail{size_, bytes.size(), writer.bytes().size()};
  stream_ << bytes;
  stream_.write(reinterpret_cast<const char*>(&tail), sizeof tail);
  stream_.close();
  if (stream_.fail()) ThrowCannotWrite(file_);
}

GroundFile::GroundFile(const std::filesystem::path& file)
    : file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}

GroundFile::~GroundFile() {
  if (file_ >= 0) ::close(file_);
}

void GroundFile::ReadAt(std::uint64_t offset, std::span<char> bytes) const {
  for (std::uint64_t done = 0; done < bytes.size();) {
    const ssize_t got =
        ::pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    Require(got > 0, ErrorCode::kInvalidInput, "it ends in the middle");
    done += static_cast<std::uint64_t>(got);
  }
}

std::string GroundFile::Bytes(std::uint64_t offset, std::uint64_t size) const {
  std::string bytes(size, '\0');
  ReadAt(offset, bytes);
  return bytes;
}

std::string GroundFile::HashOfPatches(std::uint64_t end) const {
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 16;  // stays in the cache
  Sha256 hash;
  std::string piece(kPiece, '\0');
  for (std::uint64_t begin = kMagic.size() + kDigits; begin < end; begin += piece.size()) {
    piece.resize(std::min(kPiece, end - begin));
    ReadAt(begin, piece);
    hash.Add(piece);
  }
  return hash.Finish();
}

void GroundFile::ReadIndex(const std::string& key) {
  Require(Bytes(0, kMagic.size()) == kMagic, ErrorCode::kInvalidInput, "it is of another kind");
  Require(Bytes(kMagic.size(), kDigits) == key, ErrorCode::kNotFound,
          "it was made from something else");
  Tail tail;
  const off_t length = ::lseek(file_, 0, SEEK_END);
  Require(length > static_cast<off_t>(sizeof tail), ErrorCode::kInvalidInput,
          "it ends in the middle");
  std::memcpy(&tail, Bytes(static_cast<std::uint64_t>(length) - sizeof tail, sizeof tail).data(),
              sizeof tail);
  Require(tail.size <= static_cast<std::uint64_t>(length) && tail.unpacked_size <= kMaxIndex,
          ErrorCode::kInvalidInput, "its index is damaged");
  const std::string bytes = Decompress(Bytes(tail.offset, tail.size), tail.unpacked_size);
  BinaryReader reader(bytes);
  Index index;
  reader(index);
  for (const StoredPatch& patch : index.patches)
    Require(patch.camera >= 0 && static_cast<std::size_t>(patch.camera) < index.cells.size() &&
                patch.num_samples <= kMaxSamples &&
                patch.size <= static_cast<std::uint64_t>(length),
            ErrorCode::kInvalidInput, "its index is damaged");
  Require(HashOfPatches(tail.offset) == index.hash, ErrorCode::kInvalidInput,
          "it holds a damaged piece");
  observation_ = {{},
                  index.body_from_ground,
                  index.num_images,
                  index.num_masks,
                  std::move(index.warnings),
                  std::move(index.placements)};
  cells_ = std::move(index.cells);
  patches_ = std::move(index.patches);
}

std::unique_ptr<const GroundFile> GroundFile::Open(const std::filesystem::path& file,
                                                   const std::string& key) {
  std::unique_ptr<GroundFile> opened(new GroundFile(file));
  if (opened->file_ < 0) return nullptr;
  try {
    opened->ReadIndex(key);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNotFound)
      LogWarning("the ground in '" + file.string() + "' is observed again, since " + error.what());
    return nullptr;
  }
  return opened;
}

GroundPatch GroundFile::Read(std::size_t index, int drive) const {
  const StoredPatch& stored = patches_[index];
  return {.drive = drive,
          .camera = stored.camera,
          .time = stored.time,
          .samples = DecodeSamples(Bytes(stored.offset, stored.size), stored.num_samples,
                                   cells_[static_cast<std::size_t>(stored.camera)])};
}

void StoredGround::Add(std::shared_ptr<const GroundFile> file, int drive,
                       const Trajectory& site_from_body) {
  for (std::size_t i = 0; i < file->patches().size(); ++i) {
    const StoredPatch& patch = file->patches()[i];
    const std::optional<Rigid3> pose = site_from_body.At(patch.time);
    if (!pose) continue;
    views_.push_back(
        {drive, patch.camera, patch.time, *pose, ExtentInSite(patch.extent_in_body, *pose)});
    origins_.push_back({files_.size(), i});
  }
  files_.push_back(std::move(file));
}

PosedGroundPatch StoredGround::Read(std::size_t index) const {
  const Origin& origin = origins_[index];
  return {files_[origin.file]->Read(origin.patch, views_[index].drive),
          views_[index].site_from_body};
}

}  // namespace parkade
