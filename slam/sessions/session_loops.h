#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/places/compare_bevs.h"
#include "slam/places/place_recognition.h"
#include "slam/places/place_words.h"
#include "slam/places/relative_pose.h"
#include "slam/places/rig_keyframe.h"
#include "slam/sessions/session_loop.h"

namespace parkade {

/// How two drives lie to each other, by places that both passed.
struct SessionLoops {
  std::vector<SessionLoop> links;  ///< that agree; empty where the drives do not fit
  int num_candidates = 0, num_measured = 0, num_agreeing = 0, num_rivals = 0;
  BevEvidence floor;     ///< at the links that agreed; empty where there were none
  std::string rejected;  ///< why there are no links, in a few words
};

/// How much of each link's information counts, as SharesOf computes it for loops.
std::vector<double> SharesOf(const std::vector<SessionLoop>& links,
                             const std::vector<RigKeyframe>& keyframes_a,
                             const std::vector<RigKeyframe>& keyframes_b, double reach);

/// The keyframes of a drive and their words, which are found once however many other drives it is
/// compared with.
struct ComparedDrive {
  explicit ComparedDrive(const std::vector<RigKeyframe>& drive_keyframes)
      : ComparedDrive(drive_keyframes, PlaceWords(drive_keyframes)) {}
  ComparedDrive(const std::vector<RigKeyframe>& drive_keyframes, PlaceWords of_keyframes)
      : keyframes(&drive_keyframes), words(std::move(of_keyframes)) {}

  const std::vector<RigKeyframe>* keyframes;  ///< borrowed; only where they lie is looked at
  PlaceWords words;
};

/// Measures keyframe b of one drive in keyframe a of another, each with its neighbors;
/// `pose.rejected` says why where that cannot be.
///
/// \param foretold  keyframe b in keyframe a within decimeters: features are looked for where it
///                  puts them (FindGuidedMatches); empty: everywhere
SessionLoop MeasureLink(const std::vector<RigKeyframe>& keyframes_a,
                        const std::vector<RigKeyframe>& keyframes_b, const PlaceCandidate& places,
                        const SessionLoopOptions& options, const RelativePoseOptions& relative_pose,
                        const std::optional<Rigid3>& foretold = std::nullopt);

/// How alike two drives look, 0 to 1: the mean score of their most alike keyframes; 0 where GNSS
/// puts them apart. Takes the parameters of MatchSessions and a hundredth of its time.
double SimilarityOf(const ComparedDrive& a, const ComparedDrive& b,
                    const SessionLoopOptions& options,
                    const std::optional<Rigid3>& a_from_b = std::nullopt, double sigma = 0);

/// Links two drives: keyframes that look alike are measured (EstimateRigPose), the most alike
/// first, until enough of them agree; these foretell where the drives pass each other, in either
/// direction, and there all keyframes are measured. Nothing is forced: too few agreeing links,
/// links all at one spot, another set that agrees as well (decks that look alike), or a floor that
/// is not the same (buildings that look alike) leave the drives apart.
///
/// \param keyframes_a, keyframes_b  described keyframes along either drive; odom_from_keyframe is
///                                  the drive's best trajectory
/// \param a_from_b  what GNSS says about the drives' frames; empty: nothing
/// \param sigma     [m] of a_from_b at the keyframes; links farther than reach + 3 sigma from it
///                  are not tried
SessionLoops MatchSessions(const std::vector<RigKeyframe>& keyframes_a,
                           const std::vector<RigKeyframe>& keyframes_b,
                           const SessionLoopOptions& options,
                           const RelativePoseOptions& relative_pose,
                           const std::optional<Rigid3>& a_from_b = std::nullopt, double sigma = 0);

}  // namespace parkade
