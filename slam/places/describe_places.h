#pragma once

#include <functional>

#include "core/drive_log.h"
#include "core/trajectory.h"
#include "slam/places/place.h"

namespace parkade {

struct PlaceOptions {
  double spacing = 2;             ///< [m] between places
  double spacing_deg = 25;        ///< a turn of this much makes a place too
  int max_features = 400;         ///< per image
  double max_distance = 40;       ///< [m] of points that are believed
  double max_depth_error = 0.15;  ///< sigma / distance above which a point is not believed

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("spacing", spacing);
    visit("spacing_deg", spacing_deg);
    visit("max_features", max_features);
    visit("max_distance", max_distance);
    visit("max_depth_error", max_depth_error);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Places along the drive, without features.
std::vector<Place> ChoosePlaces(const Trajectory& odom_from_body, const PlaceOptions& options);

using PlaceSink = std::function<void(Place&& place)>;

/// Looks again at images of the places that are wanted (one flag each), one per camera and place: corners with ORB
/// descriptors on upright views (CylinderView), and where neighbouring places see a corner too, its point by the
/// odometry's motion. One pass over the log; images are worked on in parallel batches. `sink` gets all places in their
/// order as they are done: only some dozens are in memory with their features.
void DescribePlaces(const DriveLog& log, const Trajectory& odom_from_body, const PlaceOptions& options,
                    const std::vector<bool>& is_wanted, std::vector<Place> places, const PlaceSink& sink);

/// Places before and after one that see the same corners.
inline constexpr size_t kNeighbourPlaces = 2;

/// The features of place `index` with points from matching features of the same camera at its neighbours.
std::vector<PlaceFeature> TriangulateFeatures(const std::vector<Place>& places, size_t index,
                                              const PlaceOptions& options);

}  // namespace parkade
