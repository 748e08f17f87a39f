#pragma once

#include <optional>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/inspection/image_sample.h"

namespace parkade {

/// A stretch of time in which the images of a camera show less than they should.
struct CameraFault {
  enum class Kind {
    kDark,       ///< next to nothing is bright
    kUnchanged,  ///< every image is the same to the last bit
    kCovered,    ///< a part of the image stays without detail while the car moves
  };
  Kind kind = Kind::kDark;
  Timestamp begin, end;  ///< stamps of the first and the last such image
  double share = 1;      ///< of the image, at least

  double Seconds() const {
    return end.ToSeconds() - begin.ToSeconds();
  }  // no overflow, whatever the stamps
};

/// "dark", "unchanged", "covered".
const char* NameOf(CameraFault::Kind kind);

/// The images of one camera in the order of the log. Keeps at most kMaxSamples samples of 330
/// bytes: one a second, in logs of hours fewer.
class ImageHistory {
 public:
  static constexpr std::size_t kMaxSamples = 4096, kMaxFaults = 10;  ///< faults of a kind

  struct Entry {
    Timestamp time;
    ImageSample sample;
  };

  /// Whether an image of this time is to be sampled; each answer counts.
  bool WantsSample(Timestamp time);
  /// Adds an image; call it for every one. Dark images need no sample.
  void Include(Timestamp time, const ImageGlance& glance, const std::optional<ImageSample>& sample);

  /// Samples of the images that are not dark.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Dark and unchanged stretches so far, in order of their begin.
  std::vector<CameraFault> Faults() const;

 private:
  /// Ends a run of images that have something in common.
  void Close(TimeSpan& run, CameraFault::Kind kind);

  double interval_ = 1;  // [s] between samples
  std::optional<Timestamp> last_sampled_;
  std::vector<Entry> entries_;
  std::uint64_t last_content_ = 0;
  TimeSpan dark_, unchanged_;  // runs that go on
  std::vector<CameraFault> faults_;
};

/// Stretches in which something covers a part of a lens, per camera: blocks that stay blind
/// although the car moves, and more of them than the camera or the others usually have. A block is
/// blind that has much less contrast than the camera shows there at its best, or the others usually
/// do at that height in the image: mud lets a little through, and the exposure brings it up. Sky
/// and bare walls are blind too, but to all cameras that see them, and not in one place for long.
/// For a single camera only a cover that comes or goes is reported. At least five seconds of
/// driving. Linear but for sorts.
std::vector<std::vector<CameraFault>> DetectOcclusion(
    const std::vector<const ImageHistory*>& cameras);

}  // namespace parkade
