#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/files/sha256.h"
#include "mapping/ground/patch_source.h"
#include "mapping/observation/observe_ground.h"
#include "server/map_folder/ground_codec.h"

namespace parkade {

/// One patch in a file.
struct StoredPatch {
  int camera = 0;
  Timestamp time;
  std::uint64_t num_samples = 0;
  std::uint64_t offset = 0, size = 0;  ///< of its bytes in the file
  Eigen::AlignedBox3d extent_in_body;  ///< [m] around its samples
};

/// Writes what one drive saw of the ground, patch by patch: a drive may see more than fits into
/// memory.
class GroundFileWriter {
 public:
  /// `key` stands for all that the patches depend on.
  GroundFileWriter(std::filesystem::path file, const std::string& key);

  void Add(const GroundPatch& patch);

  /// Writes the index. `observation.patches` are not looked at. Throws Error{kInternal} where the
  /// file is not whole.
  void Finish(const GroundObservation& observation);

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  Sha256 hash_;  // of the patches
  std::uint64_t size_ = 0;
  std::vector<StoredPatch> patches_;
  std::vector<GroundCells> cells_;  // per camera
};

/// What one drive saw of the ground, on disk: the index is in memory, samples are read when they
/// are asked for.
class GroundFile {
 public:
  /// Opens a file. Returns null where there is none, it has another key or, with a line in the log,
  /// is damaged: all of it is read and held against its SHA-256, which takes a twentieth of the
  /// time of decoding it.
  static std::unique_ptr<const GroundFile> Open(const std::filesystem::path& file,
                                                const std::string& key);

  ~GroundFile();
  GroundFile(const GroundFile&) = delete;
  GroundFile& operator=(const GroundFile&) = delete;

  /// The observation without its patches.
  const GroundObservation& observation() const { return observation_; }
  const std::vector<StoredPatch>& patches() const { return patches_; }

  /// Reads a patch as it was added, except that its drive is `drive`. Thread-safe.
  GroundPatch Read(std::size_t index, int drive) const;

 private:
  explicit GroundFile(const std::filesystem::path& file);
  void ReadIndex(const std::string& key);
  std::string HashOfPatches(std::uint64_t end) const;
  /// Fills `bytes`.
  void ReadAt(std::uint64_t offset, std::span<char> bytes) const;
  std::string Bytes(std::uint64_t offset, std::uint64_t size) const;

  int file_ = -1;
  GroundObservation observation_;
  std::vector<StoredPatch> patches_;
  std::vector<std::vector<GroundCell>> cells_;  // per camera
};

/// The stored patches of several drives, posed.
class StoredGround final : public PatchSource {
 public:
  /// Adds a drive's patches. Those at whose time `site_from_body` knows no pose are left out. Call
  /// in the order of the drives' numbers.
  void Add(std::shared_ptr<const GroundFile> file, int drive, const Trajectory& site_from_body);

  PosedGroundPatch Read(std::size_t index) const override;

 private:
  struct Origin {
    std::size_t file = 0, patch = 0;
  };
  std::vector<std::shared_ptr<const GroundFile>> files_;
  std::vector<Origin> origins_;  // in the order of views_
};

}  // namespace parkade
