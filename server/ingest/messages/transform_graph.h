#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/rigid3.h"
#include "server/ingest/messages/message_decoding.h"

namespace parkade {

/// Static transforms between named frames. A leading slash of a name does not count.
class TransformGraph {
 public:
  /// Adds a transform. One that is not finite, or whose quaternion is not of length 1 (to 1 %), is
  /// left out. A later one between the same frames replaces the earlier.
  void Add(const TransformMessage& transform);

  bool Has(const std::string& frame) const;

  /// The transform along any chain, or nothing where there is none.
  std::optional<Rigid3> Find(const std::string& target, const std::string& source) const;

 private:
  std::map<std::string, std::map<std::string, Rigid3>>
      neighbors_;  ///< [frame][other] = frame_from_other
};

/// A frame's name without a leading slash.
std::string PlainFrame(const std::string& frame);

}  // namespace parkade
