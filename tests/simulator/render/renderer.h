#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "core/rig.h"
#include "tests/simulator/rays/sample_table.h"
#include "tests/simulator/rays/shot.h"
#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

struct RenderedImage {
  cv::Mat radiance;  ///< CV_32FC3, red, green, blue, linear, as it arrives at the sensor
  cv::Mat mask;      ///< CV_8UC1, see Semantics; empty unless asked for
};

/// Takes images of a scene with the cameras of a rig, by ray tracing: four rays
/// a pixel, sixteen at edges, each at its own moment of the exposure, textures averaged over what a
/// ray covers, shadows of the sun and of lamps, mirrors of wet ground. All cores; one
/// image at a time.
class Renderer {
 public:
  /// Keeps references to `scene` and `rig`.
  Renderer(const Scene& scene, const Rig& rig, double half_field_of_view);
  ~Renderer();

  RenderedImage Render(const Shot& shot) const;

  /// See SampleTable::Mask.
  cv::Mat Mask(size_t camera) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace parkade::simulator
