#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/site_map.h"
#include "slam/georeference/fit_pins.h"

namespace parkade {

/// A pin in a drive: as another build may have another site frame, this is what carries it there.
struct PinAnchor {
  std::string drive;
  Timestamp time;                                          ///< of a pose near the pin
  Eigen::Vector3d point_in_imu = Eigen::Vector3d::Zero();  ///< [m] at that time
};

/// A point of which a reviewer knows where it lies on Earth.
struct SitePin {
  PinnedPoint place;                    ///< in the site of the map that it was last seen in
  std::vector<PinAnchor> anchors = {};  ///< the first whose drive is in a map counts there
  bool is_used = false;                 ///< that map has the drive of an anchor
};

/// "[DRIVE:]X,Y,Z=LAT,LON[,HEIGHT]": meters in the site of a finished map, degrees, meters above
/// the ellipsoid. The drive, if named, is the one anchor. Throws Error{kInvalidInput} naming the
/// text.
struct AskedPin {
  std::string drive;
  PinnedPoint place;
};
AskedPin ParsePin(const std::string& text);

/// Anchors pins in the drives of a finished map that pass near them, the nearest first. Throws
/// Error{kInvalidInput} where a pin has no drive near it or names one that is not in the map, where
/// the pins do not fit each other, and what FitPins throws.
std::vector<SitePin> AnchorPins(const std::vector<std::string>& texts,
                                const std::filesystem::path& map, const PinOptions& options);

/// Reads the pins of a finished map from its report.json.
std::vector<SitePin> ReadPins(const std::filesystem::path& map);

/// The effect of pins on a map.
struct SitePinning {
  std::vector<SitePin> pins;  ///< in the pinned site
  std::optional<PinFit>
      fit;  ///< of the used ones, in their order; nothing where they are fewer than two
  /// pinned_from_site of the pins after that of GNSS: how far both disagree, at the pins' center.
  std::optional<Rigid3> pinned_from_gnss;
  std::vector<std::string> warnings;
};

/// Moves a map whose trajectories are final to where its pins say, which overrules where it lay;
/// the datum is then at the first of them. Drives that joined since become anchors, too. Without
/// pins nothing happens. Pins that do not fit any better than the tolerance count all the same,
/// with a warning: they did when they were set.
SitePinning PinSite(std::vector<SitePin> pins, const PinOptions& options, SiteMap& map);

/// The pins as a list for report.json; ReadPins reads it.
nlohmann::ordered_json PinsToJson(const SitePinning& pinning);

/// How a map lies on Earth, how sure that is, and how high the sea is there; null without a datum.
nlohmann::ordered_json GeoreferenceToJson(const SiteMap& map, const SitePinning& pinning);

}  // namespace parkade
