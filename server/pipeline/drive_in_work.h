#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/findings/trajectory_findings.h"
#include "server/ingest/drive/recorded_drive.h"
#include "server/pipeline/built_map.h"
#include "server/pipeline/keyed.h"
#include "slam/odometry/calibrated_log.h"
#include "slam/odometry/odometry_result.h"
#include "slam/places/keyframe_store.h"
#include "slam/places/place_words.h"
#include "slam/places/rig_keyframe.h"
#include "slam/refinement/sensor_agreement.h"

namespace parkade {

/// The keyframes of a drive along its refined trajectory, for joining it with others.
struct DriveKeyframes {
  std::string key;  ///< of what they show
  // As in DriveToJoin.
  std::vector<RigKeyframe> keyframes;
  std::optional<PlaceWords> words;
  std::function<std::vector<RigKeyframe>()> describe;
};

/// A drive on its way into the map: the products of its stages so far, in their order.
struct DriveInWork {
  const RecordedDrive* log = nullptr;
  size_t index = 0;  ///< of the log among those given
  Keyed<OdometryResult> odometry;
  SensorAgreement agreement;
  bool is_odometry_taken = false;  ///< from the map that the build starts from
  LoopReview review;               ///< decisions that hold, of this build and of those before
  Keyed<LoopClosure> loops;
  std::shared_ptr<KeyframeStore> described;  ///< keyframes along the odometry; null: none yet
  Keyed<DriveRefinement> refinement;
  DriveDiagnostics diagnostics;
  std::optional<CalibratedLog> calibrated;  ///< the log as all that follows the refinement sees it
  std::optional<GnssAlignment> gnss;
  GnssVerdict gnss_verdict;
  DriveKeyframes keyframes;  ///< of several drives; a drive alone needs none
};

}  // namespace parkade
