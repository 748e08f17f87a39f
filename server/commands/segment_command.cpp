#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/calibration/rig_files.h"
#include "core/error.h"
#include "core/files/file.h"
#include "mapping/networks/freespace_network.h"
#include "mapping/observation/segment_image.h"
#include "server/commands/commands.h"
#include "server/commands/write_image.h"
#include "server/map_folder/output_folder.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

struct SegmentArguments {
  std::vector<std::string> images;
  std::string out, model, rig, camera;
  bool has_overlays = false;
};

/// Reads an image. Throws Error{kInvalidInput} naming a file that is none.
cv::Mat ReadImage(const std::string& file) {
  const std::string bytes = ReadFile(file);
  cv::Mat image;
  if (!bytes.empty()) {
    try {
      image = cv::imdecode(std::vector<uchar>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
    } catch (const cv::Exception&) {
      image.release();  // its header promises too much
    }
  }
  Require(!image.empty(), ErrorCode::kInvalidInput, "'" + file + "' is no image that can be read");
  return image;
}

/// The image with what is drivable in green.
cv::Mat Overlay(const cv::Mat& image, const cv::Mat& mask) {
  const cv::Mat green(image.size(), CV_8UC3, cv::Scalar(0, 200, 0));
  cv::Mat mixed;
  cv::addWeighted(image, 0.6, green, 0.4, 0, mixed);
  cv::Mat overlay = image.clone();
  mixed.copyTo(overlay, mask);
  return overlay;
}

/// Names of the masks, which are those of the images; two images of one name have no place in one
/// folder.
std::vector<std::string> MaskNames(const std::vector<std::string>& images) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& image : images) {
    names.push_back(fs::path(image).stem().string());
    Require(taken.insert(names.back()).second, ErrorCode::kUsage,
            "two of the images are called '" + names.back() + "': their masks would have one name");
  }
  return names;
}

/// Writes one image's mask, and its overlay where it is asked for.
std::vector<fs::path> TargetsOf(const SegmentArguments& arguments, const std::string& name) {
  std::vector<fs::path> targets = {fs::path(arguments.out) / (name + ".png")};
  if (arguments.has_overlays) targets.push_back(fs::path(arguments.out) / (name + "_overlay.jpg"));
  return targets;
}

/// Throws Error{kUsage} where a file to write would replace one of the images.
void RequireImagesStay(const SegmentArguments& arguments, const fs::path& target) {
  std::error_code ignored;  // a path that does not exist cannot be an image
  for (const std::string& image : arguments.images)
    Require(!fs::equivalent(target, image, ignored), ErrorCode::kUsage,
            "'" + target.string() + "' would replace an image: choose another --out");
}

/// The camera that took the images. Throws Error{kUsage} or {kInvalidInput} where the rig does not
/// tell.
RigCamera FindCamera(const SegmentArguments& arguments) {
  const Rig rig = ReadCameraRig(arguments.rig);
  Require(rig.vehicle.has_value(), ErrorCode::kInvalidInput,
          "the rig '" + arguments.rig + "' has no vehicle.yaml, which says where the ground is");
  std::string names;
  for (const RigCamera& camera : rig.cameras) {
    if (camera.name == arguments.camera || (arguments.camera.empty() && rig.cameras.size() == 1))
      return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  throw Error(ErrorCode::kUsage,
              "--camera must name the camera of the rig that took the images: " + names);
}

/// Finds drivable ground in images: as maps do where the camera is known, else in the images as
/// they are.
class Segmenter {
 public:
  explicit Segmenter(const SegmentArguments& arguments) {
    if (!arguments.rig.empty()) camera_ = FindCamera(arguments);
    if (camera_)
      own_ = std::make_unique<ImageNetworks>();
    else
      network_ = std::make_unique<FreespaceNetwork>(arguments.model);
  }

  cv::Mat MaskOf(const cv::Mat& image) const {
    if (!camera_) return network_->Run(image).Mask();
    return SegmentImage(*own_, camera_->model, camera_->body_from_camera, image).Mask();
  }

 private:
  std::optional<RigCamera> camera_;
  std::unique_ptr<ImageNetworks> own_;         ///< set where the camera is known
  std::unique_ptr<FreespaceNetwork> network_;  ///< set where it is not
};

int Segment(const SegmentArguments& arguments) {
  const std::vector<std::string> names = MaskNames(arguments.images);
  for (const std::string& name : names)
    for (const fs::path& target : TargetsOf(arguments, name)) RequireImagesStay(arguments, target);
  const Segmenter segmenter(arguments);
  std::error_code error;
  fs::create_directories(arguments.out, error);
  Require(fs::is_directory(arguments.out), ErrorCode::kInvalidInput,
          "cannot make the folder '" + arguments.out + "'");
  RequireWritable(arguments.out);
  for (size_t i = 0; i < names.size(); ++i) {
    const cv::Mat image = ReadImage(arguments.images[i]);
    const cv::Mat mask = segmenter.MaskOf(image);
    const std::vector<fs::path> targets = TargetsOf(arguments, names[i]);
    WriteImage(targets.front(), mask);
    if (arguments.has_overlays) WriteImage(targets.back(), Overlay(image, mask));
    std::printf("%s: %.1f %% drivable\n", names[i].c_str(),
                100.0 * cv::countNonZero(mask) / static_cast<double>(mask.total()));
  }
  return 0;
}

}  // namespace

void AddSegmentCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<SegmentArguments>();
  CLI::App* command =
      app.add_subcommand("segment", "Masks of drivable ground for images (PNG, 255 = drivable)");
  command
      ->add_option("IMAGE", arguments->images,
                   "images of any lens; read as JPEG, PNG and what else OpenCV knows")
      ->required();
  command->add_option("--out", arguments->out, "folder of the masks, made where missing")
      ->required();
  CLI::Option* model =
      command->add_option("--freespace-model", arguments->model,
                          "ONNX network to use instead of the built-in one (docs/freespace.md)");
  CLI::Option* rig = command->add_option(
      "--rig", arguments->rig,
      "calibration folder: images of its fisheyes are shown to the network as maps do it");
  rig->excludes(model);
  command
      ->add_option("--camera", arguments->camera,
                   "which camera of the rig took the images (\"cam0\")")
      ->needs(rig);
  command->add_flag("--overlay", arguments->has_overlays,
                    "also the images with what is drivable in green");
  command->callback([arguments, &action] { action = [arguments] { return Segment(*arguments); }; });
}

}  // namespace parkade
