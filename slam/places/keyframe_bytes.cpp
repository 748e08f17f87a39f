#include "slam/places/keyframe_bytes.h"

#include <algorithm>
#include <utility>

#include "core/binary_serialization.h"

namespace parkade {

// Found by argument-dependent lookup, hence in the types' own namespace.
template <typename A>
void Serialize(A& archive, KeyframeFeature& feature) {
  archive(feature.camera, feature.origin, feature.bearing, feature.sigma, feature.point,
          feature.depth_sigma);
}
template <typename A>
void Serialize(A& archive, RigKeyframe& keyframe) {
  archive(keyframe.time, keyframe.distance, keyframe.odom_from_keyframe, keyframe.features,
          keyframe.descriptors, keyframe.views);
}

namespace {

/// Where the features of a keyframe lie in its images: a section of its own, since older files lack
/// it.
struct ImagePoints {
  std::vector<Timestamp> times;
  std::vector<Eigen::Vector2f> points;  ///< as the keyframe's features
};
template <typename A>
void Serialize(A& archive, ImagePoints& images) {
  archive(images.times, images.points);
}

ImagePoints ImagePointsOf(const RigKeyframe& keyframe) {
  ImagePoints images{keyframe.image_times, {}};
  for (const KeyframeFeature& feature : keyframe.features)
    images.points.push_back(feature.image_point);
  return images;
}

void SetImagePoints(const ImagePoints& images, RigKeyframe& keyframe) {
  Require(images.points.size() == keyframe.features.size(), ErrorCode::kInvalidInput,
          "its image points do not fit");
  keyframe.image_times = images.times;
  for (size_t i = 0; i < images.points.size(); ++i)
    keyframe.features[i].image_point = images.points[i];
}

constexpr std::uint64_t kPieceBytes = std::uint64_t{1} << 20;

template <typename Value>
std::string BytesOf(Value& value) {
  BinaryWriter writer;
  writer(value);
  return std::move(writer).Take();
}

}  // namespace

KeyframesEncoder::KeyframesEncoder(size_t num_keyframes, std::function<void(std::string_view)> sink)
    : sink_(std::move(sink)) {
  std::uint64_t count = num_keyframes;
  sink_(BytesOf(count));
  floors_.Append(BytesOf(count));
  images_.Append(BytesOf(count));
}

void KeyframesEncoder::Add(RigKeyframe keyframe) {
  sink_(BytesOf(keyframe));
  floors_.Append(BytesOf(keyframe.floor));
  ImagePoints images = ImagePointsOf(keyframe);
  images_.Append(BytesOf(images));
}

void KeyframesEncoder::Finish() {
  for (const AppendedFile* file : {&floors_, &images_})
    for (std::uint64_t offset = 0; offset < file->size();) {
      const std::string piece =
          file->Read(offset, std::min<std::uint64_t>(file->size() - offset, kPieceBytes));
      sink_(piece);
      offset += piece.size();
    }
}

std::string EncodeKeyframes(const std::vector<RigKeyframe>& keyframes) {
  std::string bytes;
  KeyframesEncoder encoder(keyframes.size(), [&bytes](std::string_view piece) { bytes += piece; });
  for (const RigKeyframe& keyframe : keyframes) encoder.Add(keyframe);
  encoder.Finish();
  return bytes;
}

std::vector<RigKeyframe> DecodeKeyframes(std::string_view bytes) {
  BinaryReader reader(bytes);
  std::vector<RigKeyframe> keyframes;
  reader(keyframes);
  if (reader.is_at_end()) return keyframes;  // written by a version that knew no floors
  std::vector<cv::Mat> floors;
  reader(floors);
  Require(floors.size() == keyframes.size(), ErrorCode::kInvalidInput, "its floors do not fit");
  for (size_t i = 0; i < keyframes.size(); ++i) keyframes[i].floor = floors[i];
  if (reader.is_at_end()) return keyframes;  // written by a version that knew no image points
  std::vector<ImagePoints> images;
  reader(images);
  Require(reader.is_at_end() && images.size() == keyframes.size(), ErrorCode::kInvalidInput,
          "its image points do not fit");
  for (size_t i = 0; i < keyframes.size(); ++i) SetImagePoints(images[i], keyframes[i]);
  return keyframes;
}

}  // namespace parkade
