#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/places/compare_floors.h"
#include "slam/places/place.h"
#include "slam/places/place_words.h"
#include "slam/places/relative_pose.h"

namespace parkade {

struct DriveLinkOptions {
  int max_candidates = 3;        ///< per place, the most alike places of the other drive
  int batch = 48;                ///< candidates measured at a time, the most alike first
  int max_measured = 480;        ///< without a drive that fits: then it does not
  int min_links = 6;             ///< that agree with each other ...
  double min_spread = 6;         ///< [m] ... and lie this far apart
  double max_rival_share = 0.6;  ///< of links that agree on something else, relative to the best: more is ambiguous
  int neighbours = 1;            ///< places before and after one that are measured with it
  double reach = 4;              ///< [m] around its foretold position in which a place is looked for
  double height_reach = 1.2;     ///< [m] likewise; decks of a garage lie 2.5 m apart or more
  // Two links agree where the ways between their ends in both drives close with them, up to these.
  double closing_base = 0.15;       ///< [m], plus ...
  double closing_per_metre = 0.01;  ///< ... this share of the ways
  double closing_deg = 1.0;         ///< plus 0.02 degrees per metre
  // Drives whose places look alike lie on one floor, too, if theirs show enough to tell.
  int min_floor_tiles = 12;       ///< compared, in both drives and between them; fewer tell nothing
  double telling_floor = 0.3;     ///< share of a drive's tiles that fit its own next place; less in both tells nothing
  double min_floor_share = 0.65;  ///< of what fits within the drives, fits between them
  int all_pairs_up_to = 6;        ///< drives: of more not every pair is linked, but each drive with ...
  int partners = 3;               ///< ... these many that look most like it, and more where drives stay apart

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_candidates", max_candidates);
    visit("batch", batch);
    visit("max_measured", max_measured);
    visit("min_links", min_links);
    visit("min_spread", min_spread);
    visit("max_rival_share", max_rival_share);
    visit("neighbours", neighbours);
    visit("reach", reach);
    visit("height_reach", height_reach);
    visit("closing_base", closing_base);
    visit("closing_per_metre", closing_per_metre);
    visit("closing_deg", closing_deg);
    visit("min_floor_tiles", min_floor_tiles);
    visit("telling_floor", telling_floor);
    visit("min_floor_share", min_floor_share);
    visit("all_pairs_up_to", all_pairs_up_to);
    visit("partners", partners);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A place of one drive that is a place of another.
struct PlaceLink {
  size_t place_a = 0, place_b = 0;  ///< indices
  double score = 0;                 ///< of place recognition; 0 where the link was foretold by others
  RelativePose pose;                ///< of place b in place a
};

/// How two drives lie to each other, by places that both passed.
struct DriveLinks {
  std::vector<PlaceLink> links;  ///< that agree; empty where the drives do not fit
  int num_candidates = 0, num_measured = 0, num_agreeing = 0, num_rivals = 0;
  FloorEvidence floor;   ///< of the links that agreed; empty where there were none
  std::string rejected;  ///< why there are no links, in a few words
};

/// How much of each link's information counts, as SharesOf has it for loops.
std::vector<double> SharesOf(const std::vector<PlaceLink>& links, const std::vector<Place>& places_a,
                             const std::vector<Place>& places_b, double reach);

/// Which links agree with each other: the ways between their ends, by either drive's trajectory, close with the links.
/// A large set in which all agree with all (greedy), after J. Mangelson et al., "Pairwise Consistent Measurement Set
/// Maximization for Robust Multi-Robot Map Merging", ICRA 2018. Indices, ascending.
std::vector<size_t> FindAgreeingLinks(const std::vector<Place>& places_a, const std::vector<Place>& places_b,
                                      const std::vector<PlaceLink>& links, const DriveLinkOptions& options);

/// The places of a drive and their words, which are found once however many other drives it is compared with.
struct ComparedDrive {
  explicit ComparedDrive(const std::vector<Place>& drive_places) : places(&drive_places), words(drive_places) {}

  const std::vector<Place>* places;  ///< borrowed
  PlaceWords words;
};

/// How alike two drives look, 0 to 1: the mean score of their most alike places; 0 where GNSS puts them apart.
/// Parameters as of LinkDrives; takes a hundredth of its time.
double LikenessOf(const ComparedDrive& a, const ComparedDrive& b, const DriveLinkOptions& options,
                  const std::optional<Rigid3>& a_from_b = std::nullopt, double sigma = 0);

/// Links two drives: places that look alike are measured (EstimateRigPose), the most alike first, until enough of them
/// agree; these foretell where the drives pass each other, in either direction, and there all places are measured.
/// Nothing is forced: too few agreeing links, links all at one spot, another set that agrees as well (decks that look
/// alike), or a floor that is not the same (buildings that look alike) leave the drives apart.
///
/// \param places_a, places_b  described places along either drive; odom_from_place is the drive's best trajectory
/// \param a_from_b            what GNSS says about the drives' frames; empty: nothing
/// \param sigma               [m] of a_from_b at the places; links farther than reach + 3 sigma from it are not tried
DriveLinks LinkDrives(const std::vector<Place>& places_a, const std::vector<Place>& places_b,
                      const DriveLinkOptions& options, const RelativePoseOptions& relative_pose,
                      const std::optional<Rigid3>& a_from_b = std::nullopt, double sigma = 0);

}  // namespace parkade
