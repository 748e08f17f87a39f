#include "server/pipeline/join_site.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "server/findings/trajectory_findings.h"
#include "server/pipeline/drive_stages.h"
#include "server/pipeline/kept_pairs.h"
#include "slam/sessions/settled_drives.h"

namespace parkade {
namespace {

/// Aligns each drive to GNSS, all in one datum: that of the first drive that has one.
std::optional<SiteDatum> AlignAllToGnss(const GnssAlignOptions& options,
                                        std::vector<DriveInWork>& drives) {
  std::optional<SiteDatum> datum;
  for (DriveInWork& drive : drives) {
    if (!drive.gnss_verdict.doubt.empty()) continue;
    const GnssPositions gnss = ReadGnss(*drive.log, options);
    drive.gnss = AlignToGnss(drive.refinement.value.odom_from_body, gnss.fixes,
                             gnss.antenna_in_body, options, datum);
    GnssVerdict& verdict = drive.gnss_verdict;
    if (!drive.gnss) {
      verdict.num_too_vague = gnss.fixes.size();
      continue;
    }
    datum = drive.gnss->datum;
    verdict.num_used = static_cast<size_t>(drive.gnss->num_inliers);
    verdict.num_apart = static_cast<size_t>(drive.gnss->num_fixes) - verdict.num_used;
  }
  return datum;
}

std::vector<DriveToJoin> DescribeDrives(const BuildContext& context,
                                        std::vector<DriveInWork>& drives) {
  std::vector<DriveToJoin> to_join;
  for (DriveInWork& drive : drives) {
    if (drives.size() > 1)
      DescribeKeyframes(context, drive);
    else  // kept for maps that it is compared with, and drives that join it
      KeepKeyframes(context, drive);
    const DriveRefinement& refinement = drive.refinement.value;
    DriveKeyframes& found = drive.keyframes;
    to_join.push_back({refinement.odom_from_body, std::move(found.keyframes), drive.loops.value,
                       drive.gnss, refinement.modes, std::move(found.words),
                       std::move(found.describe)});
  }
  return to_join;
}

/// The decisions of this build and, of the one that it starts from, those that it does not
/// overrule. Keyframes, by which links are called, are those of the odometry.
LinkReview LinkReviewFor(const BuildContext& context, const std::vector<DriveInWork>& drives,
                         const std::vector<std::string>& names) {
  LinkReview review = context.scope.links;
  if (!context.from) return review;
  std::vector<LinkEnds> decided;
  for (const auto* ids : {&review.rejected, &review.forced})
    for (const std::string& id : *ids)
      if (const auto ends = FindEnds(id, names)) decided.push_back(*ends);
  const auto take = [&](const std::vector<std::string>& before, std::vector<std::string>& now) {
    for (const std::string& id : before) {
      const std::optional<LinkEnds> ends = FindEnds(id, names);
      if (ends && drives[ends->drive_a].is_odometry_taken &&
          drives[ends->drive_b].is_odometry_taken &&
          std::find(decided.begin(), decided.end(), *ends) == decided.end())
        now.push_back(id);
    }
  };
  take(context.from->ReviewOfLinks().rejected, review.rejected);
  take(context.from->ReviewOfLinks().forced, review.forced);
  return review;
}

/// The trajectory of a drive of the map to start from, as its body.
Trajectory BodyIn(const MapReader& from, const DriveInWork& drive) {
  std::vector<TrajectoryState> states = from.ReadTrajectory(drive.log->name()).states();
  const Rigid3 imu_from_body = drive.calibrated->rig().body_from_imu.Inverse();
  for (TrajectoryState& state : states)
    state.world_from_body = state.world_from_body * imu_from_body;
  return Trajectory(std::move(states));
}

/// Where the map to start from has the drives that are to stay as they lie to each other. None
/// where more is new than further drives, or when it is time to join all anew.
std::vector<std::optional<Trajectory>> SettledBefore(const BuildContext& context,
                                                     const std::vector<DriveInWork>& drives) {
  const BuildScope& scope = context.scope;
  if (!context.from || !scope.loops.empty() || !scope.links.rejected.empty() ||
      !scope.links.forced.empty())
    return {};
  const size_t num_before = context.from->drives().size();
  if (num_before >= drives.size() || IsToBeSettled(num_before, drives.size())) return {};
  std::vector<std::optional<Trajectory>> settled(drives.size());
  size_t num_settled = 0;
  for (size_t i = 0; i < drives.size(); ++i) {
    if (!context.from->Holds(drives[i].log->name(), scope.logs)) continue;
    const std::string file = drives[i].log->name() + kRefinementFile;
    if (!drives[i].is_odometry_taken || !context.cache.MapHas(file, drives[i].refinement.key))
      return {};
    try {
      settled[i] = BodyIn(*context.from, drives[i]);
    } catch (const Error& error) {
      LogWarning(std::string("all drives are joined anew: ") + error.what());
      return {};
    }
    if (settled[i]->empty()) return {};
    ++num_settled;
  }
  if (num_settled != num_before) return {};
  return settled;
}

DriveOutcome OutcomeOf(DriveInWork& drive) {
  const OdometryResult& odometry = drive.odometry.value;
  return {drive.index,
          odometry.report,
          drive.loops.value,
          drive.review,
          drive.refinement.value,
          std::move(drive.diagnostics),
          drive.gnss,
          odometry.keyframes.size(),
          TrajectoryFindings(odometry.report, odometry.rig, drive.agreement, drive.gnss_verdict)};
}

}  // namespace

void JoinSite(const BuildContext& context, std::vector<DriveInWork>& drives, BuiltMap& built) {
  const MapOptions& options = context.options;
  built.site.datum = AlignAllToGnss(options.gnss, drives);
  const std::vector<DriveToJoin> to_join = DescribeDrives(context, drives);
  const KeptPairs pairs(context, drives);
  for (const DriveInWork& drive : drives) built.names.push_back(drive.log->name());
  built.link_review = LinkReviewFor(context, drives, built.names);
  built.join =
      JoinDrives(to_join, options.loops, options.links, pairs.Find(),
                 ReviewedLinks(built.link_review, built.names), SettledBefore(context, drives));
  RequireLinks(context.scope.links, built.names, built.join.pairs);
  pairs.Keep(built.join.findings);

  bool has_gnss = false;
  std::vector<DriveInWork> kept;
  for (size_t i = 0; i < drives.size(); ++i) {
    DriveInWork& drive = drives[i];
    JoinedDrive& joined = built.join.drives[i];
    if (!joined.left_out.empty()) {
      built.left_out.push_back({drive.log->name(), "it does not fit the others: " + joined.left_out,
                                drive.index, drive.review, drive.log->health().Warnings()});
      continue;
    }
    drive.described.reset();
    has_gnss = has_gnss || drive.gnss;
    built.drives.push_back(OutcomeOf(drive));
    built.site.drives.push_back({drive.log->name(), drive.calibrated->rig(),
                                 drive.odometry.value.odom_from_body,
                                 std::move(joined.site_from_body)});
    kept.push_back(std::move(drive));
  }
  drives = std::move(kept);
  if (!has_gnss) built.site.datum.reset();
}

void PutOnEarth(const BuildContext& context, BuiltMap& built) {
  std::vector<GnssAlignment> by_gnss;
  for (const DriveOutcome& drive : built.drives)
    if (drive.gnss) by_gnss.push_back(*drive.gnss);
  if (!by_gnss.empty()) built.site.placement = PlacementBy(by_gnss);
  built.pinning = PinSite(context.scope.pins, context.options.pins, built.site);
  built.warnings.insert(built.warnings.end(), built.pinning.warnings.begin(),
                        built.pinning.warnings.end());
}

void WarnOfLosses(const std::vector<DriveInWork>& drives, BuiltMap& built) {
  std::vector<std::string>& warnings = built.warnings;
  for (const LeftOutDrive& drive : built.left_out) {
    const std::string name = "drive '" + drive.name + "'", said = name + ": ";
    warnings.push_back(name + " is left out: " + drive.reason);
    for (const std::string& warning : drive.warnings) warnings.push_back(said + warning);
  }
  for (size_t i = 0; i < built.names.size(); ++i)
    if (built.join.drives[i].is_held_by_gnss_alone)
      warnings.push_back("drive '" + built.names[i] +
                         "': no place links it to most of the other drives; GNSS alone says where "
                         "it lies among them");
  for (const DriveInWork& drive : drives) {
    const DriveLogHealth health = drive.log->health();
    const std::string name = "drive '" + drive.log->name() + "': ";
    for (const std::string& warning : health.Warnings()) warnings.push_back(name + warning);
    for (const std::string& warning :
         TextsOf(TrajectoryFindings(drive.odometry.value.report, drive.odometry.value.rig,
                                    drive.agreement, drive.gnss_verdict),
                 Severity::kWarning))
      warnings.push_back(name + warning);
    if (health.damage.is_truncated)
      warnings.push_back(name + "the log is cut off; what came after is not in the map");
    if (!health.damage.ranges.empty())
      warnings.push_back(name +
                         "parts of the log are damaged and left out, see the health of the drive");
  }
}

}  // namespace parkade
