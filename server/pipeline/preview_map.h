#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/site_map.h"
#include "server/pipeline/build_context.h"
#include "server/pipeline/drive_in_work.h"

namespace parkade {

/// A drive whose loops have just been closed.
struct ClosedDrive {
  std::string name;
  Rigid3 body_from_imu;
  const Trajectory* odometry = nullptr;
  const LoopClosure* loops = nullptr;
  bool is_odometry_taken = false;  ///< from the map that the build starts from
};

/// Shows how a map will look, moments after its trajectories are final: the ground of the map that
/// it is built from, bent as the trajectories of the drives of both have bent (DeformGround),
/// textured as it was, as a .glb. Ground that only a new drive saw is not in it yet; ground that no
/// drive came near which is left is not in it any more. `asset.extras.preview` is "final".
///
/// \param from  the finished map's folder
/// \param site  of the map in the making: drives and datum are read
/// Throws Error{kInvalidInput} where the old map has no ground, or no drive in common with `site`.
std::string EncodePreview(const std::filesystem::path& from, const LogHashes& logs,
                          const SiteMap& site);

/// Shows it as soon as loops are closed and before anything is refined: the old map's ground and
/// all its drives as one problem (RegraphSite, DeformJointly), in the frame of the old map.
/// `asset.extras.preview` is "joint". Links between drives that are rejected hold nothing. Nothing
/// where no drive of the old map has other loops than it had, or where one of them was tracked
/// again: the next preview is the final one. Throws as EncodePreview.
std::optional<std::string> EncodeJointPreview(const std::filesystem::path& from,
                                              const LogHashes& logs,
                                              std::span<const ClosedDrive> drives,
                                              const LinkReview& links, const LoopOptions& options);

// The two previews as stages of a build: written to BuildScope::preview, where there is one; each
// replaces the one before. A preview that cannot be made does not fail the build.

/// Call after all drives' loops are closed: EncodeJointPreview.
void PreviewLoops(const BuildContext& context, std::span<const DriveInWork> drives);
/// Call once trajectories are final, before there is ground: EncodePreview.
void PreviewSite(const BuildContext& context, const SiteMap& site);

}  // namespace parkade
