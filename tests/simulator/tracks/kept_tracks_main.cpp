// Tells how many of 200 corners of an image optical flow follows into the next one while the car
// drives: prints every pair with too few, and a line per drive; on request draws them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/options_json.h"
#include "core/parallel.h"
#include "tests/simulator/drives/presets.h"
#include "tests/simulator/tracks/image_pairs.h"

namespace parkade::simulator {
namespace {

struct CommandLine {
  SimulateOptions options;
  PairOptions pairs;
  std::vector<std::string> drives, assignments;
  std::vector<int> seeds = {1};
  std::filesystem::path drawings;
  int least = 150, num_threads = 0;
};

/// Both images one above the other, with a line from each corner to where it went: green when kept.
cv::Mat Drawing(const ImagePair& pair) {
  cv::Mat first, second;
  cv::cvtColor(pair.before, first, cv::COLOR_GRAY2BGR);
  cv::cvtColor(pair.after, second, cv::COLOR_GRAY2BGR);
  const FollowedCorners& followed = pair.followed;
  for (size_t i = 0; i < followed.corners.size(); ++i) {
    const cv::Scalar color = followed.is_kept[i] ? cv::Scalar(0, 220, 0) : cv::Scalar(0, 0, 255);
    for (cv::Mat* image : {&first, &second})
      cv::line(*image, followed.corners[i], followed.moved[i], color);
    cv::circle(first, followed.corners[i], 2, color);
    cv::circle(second, followed.moved[i], 2, color);
  }
  cv::Mat both;
  cv::vconcat(first, second, both);
  return both;
}

void Judge(const std::string& title, const SimulateOptions& options, const CommandLine& line) {
  std::vector<int> kept;
  std::vector<double> low_times;
  TakeImagePairs(options, line.pairs, [&](const ImagePair& pair) {
    kept.push_back(pair.followed.num_kept());
    if (kept.back() >= line.least) return;
    low_times.push_back(pair.time);
    std::printf("  %s camera %zu at %.1f s, %.1f m/s, %.0f deg/s: %d of %d\n", title.c_str(),
                pair.camera, pair.time, pair.speed, pair.turn_rate * 180 / M_PI, kept.back(),
                pair.followed.num_corners());
    if (line.drawings.empty()) return;
    const std::string name = title + "-" + std::to_string(pair.camera) + "-" +
                             std::to_string(std::lround(pair.time)) + ".png";
    cv::imwrite((line.drawings / name).string(), Drawing(pair));
  });
  if (kept.empty()) return;
  std::sort(kept.begin(), kept.end());
  std::printf("%s: %zu pairs, worst %d, median %d, below %d: %zu\n", title.c_str(), kept.size(),
              kept.front(), kept[kept.size() / 2], line.least, low_times.size());
  std::fflush(stdout);
}

int Run(CommandLine& line) {
  if (line.num_threads > 0) SetNumThreads(line.num_threads);
  if (!line.drawings.empty()) std::filesystem::create_directories(line.drawings);
  for (const std::string& drive : line.drives) {
    const Preset* preset = FindPreset(drive);
    for (const int seed : preset ? std::vector{preset->options.seed} : line.seeds) {
      SimulateOptions options = preset ? preset->options : line.options;
      if (!preset) {
        options.scene = drive;
        options.seed = seed;
      }
      SetOptions(line.assignments, options);
      Judge(drive + (preset ? "" : "-" + std::to_string(seed)), options, line);
    }
  }
  return 0;
}

}  // namespace
}  // namespace parkade::simulator

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Counts the tracks that optical flow keeps from image to image of simulated drives.",
               "parkade-kept-tracks"};
  simulator::CommandLine line;
  line.options.traffic = 2;
  app.add_option("drives", line.drives, "Scenes or presets")->required();
  app.add_option("--seed", line.seeds, "Of scenes: one drive each");
  app.add_option("--every", line.pairs.every, "[s] from pair to pair")->capture_default_str();
  app.add_option("--slowest", line.pairs.slowest, "[m/s] slower is not counted")
      ->capture_default_str();
  app.add_option("--least", line.least, "Tracks that should be kept")->capture_default_str();
  app.add_option("--draw", line.drawings, "Folder for drawings of the pairs with fewer");
  app.add_option("--set", line.assignments, "Any option of parkade-simulate: group.option=value");
  app.add_option("--threads", line.num_threads, "Default: all cores");
  CLI11_PARSE(app, argc, argv);
  try {
    return simulator::Run(line);
  } catch (const std::exception& error) {
    std::cerr << "parkade-kept-tracks: " << error.what() << "\n";
    return 1;
  }
}
