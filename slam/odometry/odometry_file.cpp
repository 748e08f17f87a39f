#include "slam/odometry/odometry_file.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

#include "core/files/appended_file.h"
#include "core/files/file.h"
#include "slam/odometry/odometry_serialization.h"
#include "slam/smoother/drive_measurements.h"
#include "slam/smoother/measurement_serialization.h"

namespace parkade {
namespace {

constexpr std::string_view kMagic = "parkade odometry";
constexpr std::uint32_t kVersion = 3;  // of the layout: other versions are tracked again

/// FNV-1a over 64 bits, of bytes that come in pieces: finds damage, not malice.
class Checksum {
 public:
  void Add(std::string_view bytes) {
    for (const char byte : bytes)
      sum_ = (sum_ ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 14695981039346656037ULL;
};

std::string_view BytesOf(const Eigen::Ref<const Eigen::VectorXd>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()),
          sizeof(double) * static_cast<size_t>(numbers.size())};
}

/// Hash of all that tracking takes from a rig. A lens counts by the rays of some of its pixels.
std::uint64_t FingerprintOf(const Rig& rig) {
  std::string bytes;
  const auto add_pose = [&bytes](const Rigid3& pose) {
    bytes += BytesOf(pose.rotation.coeffs());
    bytes += BytesOf(pose.translation);
  };
  for (const RigCamera& camera : rig.cameras) {
    bytes += camera.name;
    add_pose(camera.body_from_camera);
    bytes += BytesOf(Eigen::Vector4d(camera.time_shift, camera.line_delay, camera.model.width(),
                                     camera.model.height()));
    constexpr int kRaysPerSide = 7;
    for (int i = 0; i < kRaysPerSide * kRaysPerSide; ++i) {
      const int row = i / kRaysPerSide;
      const int column = i % kRaysPerSide;
      const Eigen::Vector2d at((column + 0.5) / kRaysPerSide * camera.model.width(),
                               (row + 0.5) / kRaysPerSide * camera.model.height());
      bytes += BytesOf(camera.model.Unproject(at).value_or(Eigen::Vector3d::Zero()));
    }
    for (int row = 0; row < camera.mask.rows; ++row)
      bytes.append(camera.mask.ptr<char>(row), static_cast<size_t>(camera.mask.cols));
  }
  const ImuCalibration& imu = rig.imu;
  bytes += BytesOf(Eigen::Vector4d(imu.accelerometer_noise_density, imu.accelerometer_random_walk,
                                   imu.gyroscope_noise_density, imu.gyroscope_random_walk));
  add_pose(rig.body_from_imu);
  bytes += BytesOf(Eigen::Vector2d(imu.accelerometer_scale, imu.gyroscope_scale));
  if (rig.vehicle)
    bytes += BytesOf(
        Eigen::Vector3d(rig.vehicle->wheelbase, rig.vehicle->track, rig.vehicle->wheel_scale));
  Checksum checksum;
  checksum.Add(bytes);
  return checksum.sum();
}

// A file is the magic, the head and the content: the trajectory, keyframes, landmarks, cameras, the
// report, nodes, images, and what all nodes share.

struct Head {
  std::uint32_t version = kVersion;
  std::uint64_t fingerprint = 0;
  std::uint64_t checksum = 0;  ///< of the content
};

/// What a file holds of one camera beyond its lens.
struct StoredCamera {
  std::string name;
  Rigid3 body_from_camera;
  double time_shift = 0, line_delay = 0;
};

template <typename A>
void Serialize(A& archive, Head& head) {
  archive(head.version, head.fingerprint, head.checksum);
}
template <typename A>
void Serialize(A& archive, StoredCamera& camera) {
  archive(camera.name, camera.body_from_camera, camera.time_shift, camera.line_delay);
}
/// The content on its way into a file.
class ContentWriter {
 public:
  explicit ContentWriter(AppendedFile& file) : file_(file) {}

  template <typename... Values>
  void operator()(Values&... values) {
    encoder_(values...);
    Pass(encoder_.bytes());
    encoder_.Clear();
  }
  /// Adds bytes that are encoded already.
  void Pass(std::string_view bytes) {
    checksum_.Add(bytes);
    file_.Append(bytes);
  }
  void Count(std::uint64_t count) { (*this)(count); }
  template <typename Item>
  void All(const std::vector<Item>& items) {
    Count(items.size());
    for (Item item : items) (*this)(item);
  }
  std::uint64_t checksum() const { return checksum_.sum(); }

 private:
  AppendedFile& file_;
  BinaryWriter encoder_;
  Checksum checksum_;
};

/// The rest of a file, for BinaryReaderOf.
class BytesOfFile {
 public:
  BytesOfFile(std::ifstream& stream, std::uint64_t num_left)
      : stream_(&stream), num_left_(num_left) {}
  std::uint64_t num_left() const { return num_left_; }
  void Take(char* data, size_t size) {
    const auto count = static_cast<std::streamsize>(size);
    Require(stream_->rdbuf()->sgetn(data, count) == count, ErrorCode::kInvalidInput,
            "the file ends in the middle");
    num_left_ -= size;
  }

 private:
  std::ifstream* stream_;
  std::uint64_t num_left_;
};

using FileReader = BinaryReaderOf<BytesOfFile>;

void WriteMeasurements(const DriveMeasurements& measurements, ContentWriter& content) {
  content.Count(measurements.nodes.size());
  for (size_t i = 0; i < measurements.nodes.size(); ++i) {
    RecordedNode node = measurements.nodes[i];
    content(node);
    content.Pass(measurements.IntervalBytes(i));
  }
  content.Count(measurements.num_images());
  for (size_t i = 0; i < measurements.num_images(); ++i) content.Pass(measurements.ImageBytes(i));
  SharedFindings shared = measurements.shared;
  content(shared);
}

std::shared_ptr<const DriveMeasurements> ReadMeasurements(FileReader& content,
                                                          const ImuCalibration& imu) {
  auto measurements = std::make_shared<DriveMeasurements>(imu);
  for (std::uint64_t left = content.Count(0); left > 0; --left) {
    RecordedNode node;
    std::optional<RecordedInterval> interval;
    content(node, interval);
    Require(!interval || interval->samples.size() > 1, ErrorCode::kInvalidInput,
            "it holds a stretch without IMU data");
    measurements->AddNode(node, std::move(interval));
  }
  for (std::uint64_t left = content.Count(0); left > 0; --left) {
    RecordedImage image;
    content(image);
    measurements->AddImage(std::move(image));
  }
  content(measurements->shared);
  return measurements;
}

/// The log's rig with the calibration of `cameras`.
Rig Calibrated(const Rig& rig, const std::vector<StoredCamera>& cameras) {
  Require(cameras.size() == rig.cameras.size(), ErrorCode::kInvalidInput,
          "it was made with " + std::to_string(cameras.size()) + " cameras, not " +
              std::to_string(rig.cameras.size()));
  Rig calibrated = rig;
  for (size_t i = 0; i < cameras.size(); ++i) {
    const StoredCamera& camera = cameras[i];
    RigCamera& restored = calibrated.cameras[i];
    Require(
        camera.name == restored.name, ErrorCode::kInvalidInput,
        "it was made with camera '" + camera.name + "' where the log has '" + restored.name + "'");
    restored.body_from_camera = camera.body_from_camera;
    restored.time_shift = camera.time_shift;
    restored.line_delay = camera.line_delay;
  }
  return calibrated;
}

/// All but the measurements, which come last.
OdometryResult ReadContent(FileReader& content, const Rig& rig) {
  OdometryResult odometry;
  std::vector<StoredCamera> cameras;
  content(odometry.odom_from_body, odometry.keyframes, odometry.landmarks, cameras,
          odometry.report);
  odometry.rig = Calibrated(rig, cameras);
  return odometry;
}

/// Checksum of what is left of `stream`.
Checksum ChecksumOf(std::ifstream& stream) {
  Checksum checksum;
  std::string piece(AppendedFile::kBufferBytes, '\0');
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0)
    checksum.Add({piece.data(), static_cast<size_t>(stream.gcount())});
  return checksum;
}

/// A file whose head says that it holds odometry of a drive with this rig.
class StoredOdometry {
 public:
  StoredOdometry(const std::filesystem::path& file, const Rig& rig)
      : stream_(file, std::ios::binary), name_("'" + file.filename().string() + "' ") {
    Require(stream_.good(), ErrorCode::kNotFound, "cannot read '" + file.string() + "'");
    std::string magic(kMagic.size(), '\0');
    stream_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
    Require(magic == kMagic, ErrorCode::kInvalidInput, name_ + "holds no odometry");
    content_.emplace(stream_, std::filesystem::file_size(file) - kMagic.size());
    (*content_)(head_);
    Require(head_.version == kVersion, ErrorCode::kInvalidInput,
            name_ + "is of version " + std::to_string(head_.version) + ", this program reads " +
                std::to_string(kVersion) + ": track the drive again");
    Require(head_.fingerprint == FingerprintOf(rig), ErrorCode::kInvalidInput,
            name_ + "was made with another calibration");
  }

  /// Before anything of the content is read.
  void Check() {
    const auto begin = stream_.tellg();
    Require(ChecksumOf(stream_).sum() == head_.checksum, ErrorCode::kInvalidInput,
            name_ + "is damaged");
    stream_.clear();
    stream_.seekg(begin);
  }
  FileReader& content() { return *content_; }
  const std::string& name() const { return name_; }  ///< quoted, and a space

 private:
  std::ifstream stream_;
  std::string name_;
  std::optional<FileReader> content_;
  Head head_;
};

std::string EncodedHead(Head head) {
  BinaryWriter writer;
  writer(head);
  return writer.bytes();
}

}  // namespace

void WriteOdometry(const OdometryResult& odometry, const Rig& rig,
                   const std::filesystem::path& file) {
  std::vector<StoredCamera> cameras;
  for (const RigCamera& camera : odometry.rig.cameras)
    cameras.push_back({camera.name, camera.body_from_camera, camera.time_shift, camera.line_delay});
  OdometryReport report = odometry.report;
  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    AppendedFile written(temporary);
    Head head{.fingerprint = FingerprintOf(rig)};
    written.Append(kMagic);
    written.Append(EncodedHead(head));
    ContentWriter content(written);
    content.All(odometry.odom_from_body.states());
    content.All(odometry.keyframes);
    content.All(odometry.landmarks);
    content(cameras, report);
    const DriveMeasurements none(rig.imu);
    WriteMeasurements(odometry.measurements ? *odometry.measurements : none, content);
    head.checksum = content.checksum();
    written.Overwrite(kMagic.size(), EncodedHead(head));
  });
}

OdometryResult ReadOdometry(const std::filesystem::path& file, const Rig& rig) {
  StoredOdometry stored(file, rig);
  stored.Check();
  OdometryResult odometry = ReadContent(stored.content(), rig);
  odometry.measurements = ReadMeasurements(stored.content(), rig.imu);
  Require(stored.content().is_at_end(), ErrorCode::kInvalidInput,
          stored.name() + "is longer than it says");
  return odometry;
}

OdometryResult ReadOdometryAlone(const std::filesystem::path& file, const Rig& rig) {
  StoredOdometry stored(file, rig);
  return ReadContent(stored.content(), rig);
}

}  // namespace parkade
