#include "server/ingest/drive/intact_images.h"

#include <algorithm>

namespace parkade {

bool IntactImages::Has(int stream, Timestamp time) const {
  const std::lock_guard lock(mutex_);
  const auto found = times_.find(stream);
  return found != times_.end() &&
         std::binary_search(found->second.begin(), found->second.end(), time);
}

void IntactImages::Add(int stream, Timestamp time) {
  const std::lock_guard lock(mutex_);
  std::vector<Timestamp>& times = times_[stream];
  const auto place = std::lower_bound(times.begin(), times.end(), time);
  if (place == times.end() || *place != time) times.insert(place, time);
}

}  // namespace parkade
