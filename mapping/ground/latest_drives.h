#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "mapping/ground/patch_source.h"

namespace parkade {

/// Which views have a say in what a place looks like: those of the latest few drives that looked at
/// it well, and of the latest few that did so from near, of each of them the nearest. What earlier
/// drives saw would be outweighed anyway, since evidence is bounded, and so what a site costs is in
/// proportion to its ground and not to the number of its drives. Asked of squares of 4 m, deck by
/// deck; by where views reach, not by what they show: from the next aisle much may hide a place
/// from all of them. A view of the latest drive that is chosen for one square counts in all, others
/// only in those to which they are of the nearest. A view that looks at the middles of squares, but
/// of none in which its drive has a say, is left out; one too small to look at any is kept.
class LatestDrives {
 public:
  /// \param views  drive after drive, the latest last; borrowed
  LatestDrives(std::span<const PatchView> views, int max_drives);

  /// Where samples of one view count.
  class Share {
   public:
    bool is_none() const { return num_counting_ == 0; }
    /// [m] around all that counts; empty where nothing does.
    Eigen::AlignedBox2d Extent() const;
    /// That of a sample which lies at `point_in_site` on its car's plane.
    bool Counts(const Eigen::Vector2d& point_in_site) const;

   private:
    friend class LatestDrives;
    int x_ = 0, y_ = 0, width_ = 0, height_ = 0;  // squares that the view reaches into
    std::vector<bool> counts_;
    int num_counting_ = 0;

    void Leave(const Eigen::Vector2i& square);
  };
  /// `index` is that of the view.
  const Share& ShareOf(std::size_t index) const { return shares_[share_of_[index]]; }

  /// Whether it counts that a drive's car stood there: not where the latest car that drove there is
  /// that of a drive that has a say, and this one has none. One without views counts everywhere.
  bool CountsAsDriven(int drive, const Eigen::Vector3d& car_in_site) const;

 private:
  using Square = std::tuple<int, int, int>;  // deck, y, x
  /// By square and rank of the drive.
  using NumViews = std::map<Square, std::map<int, int>>;
  using SquareOfDrive = std::pair<Square, int>;  // and the drive's rank

  /// `car_height` [m] tells decks apart.
  static Square SquareOf(double car_height, const Eigen::Vector2d& point_in_site);
  static Square SquareOf(const PatchView& view, const Eigen::Vector2d& point_in_site) {
    return SquareOf(view.site_from_body.translation.z(), point_in_site);
  }
  template <typename Visitor>
  static void ForEachMiddle(const PatchView& view, const Visitor& visit);
  static std::map<Square, int> FindOldest(const NumViews& num_views, int max_drives);
  void FindNear(const NumViews& num_near_views, int max_drives);
  void ChooseViews(const NumViews& num_views);
  Share FullShareOf(std::size_t index) const;
  bool HasSay(int rank, const Square& square) const;

  std::span<const PatchView> views_;
  std::map<int, int> ranks_;  // of drives, in the order of the views
  std::map<Square, int>
      oldest_;  // rank of the first drive that counts; squares where all count are left out
  std::set<SquareOfDrive> near_;         // earlier drives that count as they looked from near
  std::map<Square, int> last_driven_;    // rank of the latest drive whose car stood there
  std::vector<std::uint32_t> share_of_;  // by view
  std::vector<Share> shares_;            // the first is none
};

}  // namespace parkade
