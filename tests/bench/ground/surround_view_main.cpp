#include <CLI/CLI.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/bench/ground/surround_view.h"
#include "tests/bench/odometry/run_bench.h"

namespace parkade {
namespace {

constexpr const char* kFooter =
    R"(Real fisheyes around a car (imgs/, intrinsic/, extrinsic/ of OpenCalib's SensorsCalibration) as one image from above,
through the ocam model: paint joins from camera to camera once their places are refined.
Example: parkade-surround-view ../shared/data/surround_garage --out above.png)";

void Print(const SurroundRig& rig, const char* when) {
  std::cout << when << ": neighbors agree by";
  for (const double agreement : AgreementOfNeighbors(rig, 1)) std::cout << " " << agreement;
  std::cout << ", ground " << rig.ground << "\n";
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app("The ground around a real car from above", "parkade-surround-view");
  app.footer(kFooter);
  std::string folder, out, before;
  double half_side = 12, texel = 0.015;
  int num_threads = 2;
  app.add_option("folder", folder, "What was published")->required();
  app.add_option("--out", out, "PNG")->required();
  app.add_option("--before", before, "PNG, with the places as published");
  app.add_option("--half-side", half_side, "Of the image, in the publisher's unit")
      ->capture_default_str();
  app.add_option("--texel", texel, "Also")->capture_default_str();
  app.add_option("--threads", num_threads)->capture_default_str();
  return RunBench(app, argc, argv, num_threads, [&] {
    SurroundRig rig = ReadOpenCalib(folder);
    for (const SurroundCamera& camera : rig.cameras)
      std::cout << camera.name << ": ocam fitted to " << camera.fit_error << " px rms\n";
    Print(rig, "as published");
    if (!before.empty()) cv::imwrite(before, ViewFromAbove(rig, half_side, texel));
    AlignNeighbors(rig);
    Print(rig, "refined");
    cv::imwrite(out, ViewFromAbove(rig, half_side, texel));
    return 0;
  });
}
