#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/appended_file.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Keyframes as bytes. Little-endian, without a version: whoever keeps them knows what they are.
/// Exact: what is read equals what was written. Reading throws Error{kInvalidInput} for other
/// bytes. Maps that older versions made are compared with and joined: new sections go to the end,
/// and what lacks them stays readable.
std::string EncodeKeyframes(const std::vector<RigKeyframe>& keyframes);
std::vector<RigKeyframe> DecodeKeyframes(std::string_view bytes);

/// Encodes like EncodeKeyframes, in pieces, keyframes that come one by one. Holds one at a time:
/// floors and where features lie in images come last, and wait on disk.
class KeyframesEncoder {
 public:
  /// `num_keyframes` will be added. `sink` gets the bytes in order.
  KeyframesEncoder(size_t num_keyframes, std::function<void(std::string_view)> sink);
  void Add(RigKeyframe keyframe);
  /// Call last: hands on what waited.
  void Finish();

 private:
  std::function<void(std::string_view)> sink_;
  AppendedFile floors_, images_;
};

}  // namespace parkade
