#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/surface_map.h"
#include "core/trajectory.h"
#include "core/triangle_mesh.h"
#include "slam/loops/close_loops.h"
#include "slam/sessions/reviewed_links.h"

namespace parkade {

/// SHA-256 of logs, by drive; other logs are unknown. A drive of a finished map is also one of a
/// new map if both have its name and their logs, where both are known, are equal.
using LogHashes = std::map<std::string, std::string>;

/// A folder that `parkade map` left, opened again.
class MapReader {
 public:
  /// Throws Error{kNotFound} where there is no folder, Error{kInvalidInput} where it holds no map.
  explicit MapReader(const std::filesystem::path& folder);

  bool Has(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  /// The path of one of the map's files. Throws Error{kInvalidInput} where this map does not have
  /// it.
  std::filesystem::path FileNamed(const std::string& name) const;

  /// The path of a file of a drive. `drive` may be empty where the map has only one. Throws
  /// Error{kUsage} naming the drives.
  std::filesystem::path FileOfDrive(const std::string& drive, const std::string& name) const;

  TriangleMesh ReadGround() const;
  Trajectory ReadTrajectory(const std::string& drive) const;  ///< final, site_from_imu
  SurfaceMap ReadSurfaceMap() const;                          ///< without colors

  const std::vector<std::string>& drives() const { return drives_; }
  /// Whether it has a drive of this name, made from the log with this hash where both say from
  /// which.
  bool Holds(const std::string& drive, const std::string& log) const;
  bool Holds(const std::string& drive, const LogHashes& logs) const;

  // Whether a drive of this name, even one that the map left out, may have been made from the log
  // with this hash: only two hashes that differ tell.
  bool MayBeOf(const std::string& drive, const std::string& log) const;
  /// SHA-256 of the log that a drive was made from; empty where the map does not say.
  std::string LogOf(const std::string& drive) const;
  /// The text of OdometryFingerprint (odometry_fingerprint.h) that a drive was tracked with.
  std::string OdometryFingerprint(const std::string& drive) const;
  /// Reviewers' decisions on a drive's loops, in this version or in those that it was made from.
  LoopReview ReviewOf(const std::string& drive) const;
  /// The same on links between its drives.
  const LinkReview& ReviewOfLinks() const { return link_review_; }

  const std::optional<SiteDatum>& datum() const { return datum_; }
  /// Sigmas [m] east, north and up of where any part of the map lies on Earth; 3 m and 5 m of
  /// height where the map does not say.
  const Eigen::Vector3d& PlacementSigma() const { return placement_sigma_; }

 private:
  /// Takes in what `drive`, one entry of `report`, says of how it was made.
  void Remember(const nlohmann::json& report, const nlohmann::json& drive);

  std::filesystem::path folder_;
  std::vector<std::string> drives_;
  std::map<std::string, std::string> logs_, tracked_by_;
  std::map<std::string, LoopReview> reviews_;
  LinkReview link_review_;
  std::optional<SiteDatum> datum_;
  Eigen::Vector3d placement_sigma_{3, 3, 5};
};

}  // namespace parkade
