#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// When the images of a log's cameras were taken.
struct PictureTimes {
  struct Camera {
    std::string name;
    std::vector<Timestamp> times;  ///< strictly increasing
  };
  std::vector<Camera> cameras;

  /// The number of a camera. Throws Error{kNotFound} naming those that there are.
  size_t NumberOf(const std::string& camera) const;
};

/// Reads them from the index that `parkade pictures` made. Throws Error{kInvalidInput} for anything
/// else.
PictureTimes ParsePictureTimes(const std::string& index);

/// The one of `times` next to `time`, the earlier of two that are as near; nothing where none is
/// within `patience` [s].
std::optional<Timestamp> NearestTime(const std::vector<Timestamp>& times, Timestamp time,
                                     double patience);

}  // namespace parkade
