#include "server/map_folder/heights_file.h"

#include "core/binary_serialization.h"

namespace parkade {

// Found by argument-dependent lookup, hence in the types' own namespace.
template <typename A>
void Serialize(A& archive, DriveHeight& height) {
  archive(height.time, height.point_in_body, height.weight, height.sigma);
}
template <typename A>
void Serialize(A& archive, TimedPose& pose) {
  archive(pose.time, pose.world_from_frame);
}
template <typename A>
void Serialize(A& archive, HeightsAlong& along) {
  archive(along.path, along.num_swept);
}
template <typename A>
void Serialize(A& archive, DriveHeights& heights) {
  archive(heights.lean.roll, heights.lean.pitch, heights.lean.heave, heights.plane_errors,
          heights.swept, heights.planes, heights.along);
}

std::string EncodeHeights(DriveHeights heights) {
  BinaryWriter writer;
  writer(heights);
  return writer.bytes();
}

DriveHeights DecodeHeights(std::string_view bytes) {
  BinaryReader reader(bytes);
  DriveHeights heights;
  reader(heights);
  Require(reader.is_at_end(), ErrorCode::kInvalidInput, "it is longer than it says");
  std::uint64_t left = heights.swept.size();
  for (const HeightsAlong& along : heights.along) {
    Require(along.num_swept <= left, ErrorCode::kInvalidInput, "it has fewer heights than it says");
    left -= along.num_swept;
  }
  Require(left == 0, ErrorCode::kInvalidInput, "it has more heights than it says");
  return heights;
}

}  // namespace parkade
