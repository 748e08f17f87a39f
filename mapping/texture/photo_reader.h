#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/drive_log.h"
#include "mapping/texture/chart_painter.h"

namespace parkade {

/// The photos of one drive that were chosen, by camera and time.
using PhotoChoice = std::map<std::pair<int, Timestamp>, GroundPhoto>;

/// Reads the images of chosen photos, a batch at a time. Both borrowed; only chosen images are decoded.
class PhotoReader {
 public:
  PhotoReader(const DriveLog& log, const PhotoChoice& choice);

  /// The next ones, with their images; none after the last.
  std::vector<GroundPhoto> Next();

 private:
  const PhotoChoice* choice_;
  std::unique_ptr<RecordStream> stream_;
  std::size_t num_left_;
};

}  // namespace parkade
