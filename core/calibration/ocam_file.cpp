#include "core/calibration/ocam_file.h"

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

/// The numbers of each line that is no comment.
std::vector<std::vector<double>> LinesOf(const std::string& text) {
  std::vector<std::vector<double>> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    if (!numbers.empty()) lines.push_back(std::move(numbers));
  }
  return lines;
}

}  // namespace

YAML::Node ReadOcamFile(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
  const std::string name = "'" + file.filename().string() + "'";
  const auto lines = LinesOf(ReadFile(file, kMaxBytes));
  // The polynomial, its inverse, the center, the affine part, the size.
  const bool is_whole = lines.size() == 5 && lines[2].size() == 2 && lines[3].size() == 3 &&
                        lines[4].size() == 2 && lines[0].size() >= 2 &&
                        lines[0][0] == static_cast<double>(lines[0].size() - 1);
  Require(is_whole, ErrorCode::kInvalidInput, name + " is no calib_results.txt of OCamCalib");
  std::vector<double> a(lines[0].begin() + 1, lines[0].end());
  for (std::size_t i = 5; i < a.size(); ++i)
    Require(a[i] == 0, ErrorCode::kInvalidInput,
            name + " has a polynomial of degree " + std::to_string(a.size() - 1) +
                ", of which Parkade knows 4 at most: calibrate with the degree 4");
  a.resize(5, 0.0);
  Require(a[1] == 0, ErrorCode::kInvalidInput,
          name + " has a polynomial with a linear part, which Parkade's lens cannot hold");
  const double c = lines[3][0], d = lines[3][1], e = lines[3][2];
  Require(std::isfinite(c) && c > 0, ErrorCode::kInvalidInput,
          name + " has an affine part that mirrors the image");
  // row = c x + d y, column = e x + y, with x down and y to the right. Ours is the other way round
  // and has no factor before the row: coordinates of the sensor are stretched by c.
  YAML::Node lens;
  lens["intrinsics"] = std::vector<double>{a[0] * c, a[2] / c, a[3] / (c * c), a[4] / (c * c * c)};
  lens["centre"] = std::vector<double>{lines[2][1], lines[2][0]};
  lens["affine"] = std::vector<double>{1 / c, e / c, d / c};
  lens["resolution"] = std::vector<double>{lines[4][1], lines[4][0]};
  return lens;
}

}  // namespace parkade
