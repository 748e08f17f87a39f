#include "server/commands/write_image.h"

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {

void WriteImage(const std::filesystem::path& file, const cv::Mat& image) {
  std::vector<uchar> bytes;
  const std::string extension = file.extension().string();
  Require(cv::haveImageWriter(extension), ErrorCode::kUsage,
          "'" + file.string() + "' has the extension of no image that can be written: .png");
  cv::imencode(extension, image, bytes);
  WriteFileAtomically(file, std::string(bytes.begin(), bytes.end()));
}

}  // namespace parkade
