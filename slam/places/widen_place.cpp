#include "slam/places/widen_place.h"

#include <algorithm>

namespace parkade {

Place WidenPlace(const std::vector<Place>& places, size_t index, size_t reach) {
  Place wide = places[index];
  const size_t begin = index - std::min(index, reach), end = std::min(index + reach + 1, places.size());
  for (size_t i = begin; i < end; ++i) {
    if (i == index || places[i].descriptors.empty()) continue;
    const Rigid3 place_from_neighbour = wide.odom_from_place.Inverse() * places[i].odom_from_place;
    for (PlaceFeature feature : places[i].features) {
      feature.origin = place_from_neighbour * feature.origin;
      feature.bearing = place_from_neighbour.rotation * feature.bearing;
      if (feature.point) feature.point = place_from_neighbour * *feature.point;
      wide.features.push_back(feature);
    }
    wide.descriptors.push_back(places[i].descriptors);
  }
  return wide;
}

}  // namespace parkade
