#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/drive_log.h"
#include "mapping/texture/chart_painter.h"

namespace parkade {

/// The images of one drive that were chosen, by camera and time.
using ImageChoice = std::map<std::pair<int, Timestamp>, GroundImage>;

/// Reads the images of chosen images, a batch at a time. Both borrowed; only chosen images are
/// decoded.
class ImageReader {
 public:
  ImageReader(const DriveLog& log, const ImageChoice& choice);

  /// The next ones, with their images; none after the last.
  std::vector<GroundImage> Next();

 private:
  const ImageChoice* choice_;
  std::unique_ptr<RecordStream> stream_;
  std::size_t num_left_;
};

}  // namespace parkade
