// The parts that several robots have made of a map, and what was measured between them. Parts of
// one group lie in one frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/localization/session/joint_poses.hpp"
#include "topogeo/localization/session/kept_views.hpp"
#include "topogeo/localization/session/map_part.hpp"
#include "topogeo/localization/session/meeting.hpp"
#include "topogeo/localization/session/slam_counts.hpp"

namespace topogeo::localization {

struct RobotPart {
  using MapPointer = MapPart::MapPointer;
  MapPart map;
  std::string robot;                               ///< empty: a stored map
  std::uint32_t group = 0;                         ///< number of its first part
  std::map<std::uint32_t, Meeting> meetings = {};  ///< with the others of a group
  std::vector<MapPointer> last = {};               ///< newest stops, the last one last
};

class RobotParts {
 public:
  /// One more part, in a group of its own.
  RobotPart& add(MapPart part, const std::string& robot);
  /// Number of the next part.
  [[nodiscard]] std::uint32_t next() const { return next_; }

  /// In the order in which they began.
  [[nodiscard]] const std::vector<std::unique_ptr<RobotPart>>& all() const { return parts_; }
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// Group of the first one: the map. Not without parts.
  [[nodiscard]] std::uint32_t root() const { return parts_.front()->group; }
  [[nodiscard]] std::set<std::uint32_t> groups() const;
  /// The parts of a group, without that one.
  [[nodiscard]] std::vector<MapPart*> group(std::uint32_t number,
                                            const RobotPart* without = nullptr) const;
  /// The same in the order of their first stops, whichever came first; only those with stops.
  [[nodiscard]] std::vector<RobotPart*> by_first_stop(std::uint32_t number) const;
  /// To which stops of the robot come; null: none.
  [[nodiscard]] RobotPart* live(const std::string& robot) const;
  /// That has the stop; null: none.
  [[nodiscard]] RobotPart* part_of(const topomap::StopId& stop) const;
  /// In the frame of its group.
  [[nodiscard]] std::optional<UncertainPose> pose_of(const topomap::StopId& stop) const;

  /// No stop comes to the part any more. A group other than the map to which none comes at all is
  /// dropped: it will never join.
  void end(RobotPart& part);
  /// Makes two groups one, `moved` in the frame of `kept`. Returns the parts of `moved`.
  std::vector<RobotPart*> unite(std::uint32_t kept, std::uint32_t moved,
                                const geometry::Pose2& T_kept_moved);

  /// Those of a group to which no stop comes any more.
  [[nodiscard]] std::vector<MapPart*> over(std::uint32_t number) const;
  /// Makes them one: `map`, all of their stops one part after the other with what was measured
  /// between them, without the views that are not kept. What links others to one that has left
  /// leads to the view that stands for it.
  void replace_over(std::uint32_t number, const StoredMap& map, const KeptViews& kept);

  /// False when the two stops were linked before.
  bool link(const Sighting& sighting);
  void link(const PartLink& link) { links_.push_back(link); }
  /// Takes away how this stop was matched with others, but for the outvoted ones.
  void unlink(const topomap::StopId& stop);
  /// Takes away the matches that the poses, as all measurements have placed them, contradict. They
  /// are not taken in again.
  void drop_outvoted_links();
  [[nodiscard]] std::span<const PartLink> links() const { return links_; }

  /// Of all parts and meetings, those that have gone included.
  [[nodiscard]] SlamCounts counts() const;
  void count(const SlamCounts& gone) { add_counts(gone_, gone); }

 private:
  void drop(std::uint32_t group);

  std::vector<std::unique_ptr<RobotPart>> parts_;
  std::uint32_t next_ = 0;
  std::vector<PartLink> links_;
  std::set<std::pair<topomap::StopId, topomap::StopId>> linked_;
  SlamCounts gone_;
};

/// Of all these parts.
std::size_t stops_of(std::span<MapPart* const> parts);

}  // namespace topogeo::localization
