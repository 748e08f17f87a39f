#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace parkade {

/// Writes an image in the format that the file's extension names, all at once. Throws Error where
/// the file cannot be written.
void WriteImage(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace parkade
