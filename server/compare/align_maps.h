#pragma once

#include <string>
#include <vector>

#include "core/rigid3.h"
#include "server/map_folder/map_reader.h"

namespace parkade {

/// One instant of a drive in both maps.
struct PosePair {
  Rigid3 in_from, in_to;
};

/// A drive that both maps hold.
struct SharedDrive {
  std::string name;
  std::vector<PosePair> poses;  ///< not empty
};

/// The drives whose names both hold, made from one log where both say from which.
bool BothHold(const MapReader& a, const MapReader& b, const std::string& drive);

/// Drives that both maps hold, in the order of the later map's.
std::vector<SharedDrive> FindSharedDrives(const MapReader& from, const MapReader& to);

/// Where the earlier map's site lies in the later one's.
struct SiteAlignment {
  Rigid3 to_from_from;  ///< a rotation about z and a translation
  std::string
      aligned_by;  ///< "drives": those that both hold; "places": those that drives of both passed;
                   ///< "datum": by where both lie on Earth, without any registration
  double horizontal_sigma = 0;  ///< [m] per axis, of a spot of the earlier map in the later one
  double height_sigma = 0;      ///< [m]
  size_t num_links = 0;         ///< between keyframes of both maps, as far as they agree
  std::string note;  ///< a sentence for the reader where not all can be compared; else empty
};

/// Aligns two maps by shared drives where there are any; else by keyframes (RegisterSites, started
/// from where both lie on Earth, if anywhere). Where no place is recognized the datum remains:
/// heights are then moved so that the two grounds lie on each other in the median, and the sigmas
/// are those of the two placements. Throws Error{kInvalidInput} where nothing says how the maps lie
/// to each other, or where they lie in different towns.
SiteAlignment AlignMaps(const std::vector<SharedDrive>& shared, const MapReader& from,
                        const MapReader& to);

}  // namespace parkade
