#pragma once

#include <memory>
#include <vector>

#include "core/drive_log.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/height_field.h"

namespace parkade {

/// A square site of `hectares` with a lane of 10 m every 50 m, a fifth of it, and what a car with
/// one camera saw that drove through all of them: nothing of it is in memory, all of it is made
/// when it is asked for.
class LargeSite {
 public:
  explicit LargeSite(double hectares);

  double side() const { return side_; }  ///< [m]
  const Rig& rig() const { return rig_; }
  const DrivenPath& path() const { return path_; }
  const PatchSource& patches() const { return *patches_; }

  /// [m] as if an instrument had measured every 0.4 m, as far as the car saw.
  std::vector<HeightObservation> Heights() const;

  /// The drive's images, all the same.
  std::unique_ptr<DriveLog> Log() const;

 private:
  double side_;
  Rig rig_;
  DrivenPath path_;
  std::unique_ptr<PatchSource> patches_;
};

}  // namespace parkade
