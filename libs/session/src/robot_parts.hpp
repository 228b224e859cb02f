// The parts of a map made by several robots, and the measurements between them. Parts of one group
// lie in one frame.
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

#include "topogeo/session/kept_views.hpp"
#include "topogeo/session/merge_proposals.hpp"

#include "joint_poses.hpp"
#include "map_part.hpp"
#include "slam_counts.hpp"

namespace topogeo::localization {

struct RobotPart {
  using MapPointer = MapPart::MapPointer;
  MapPart map;
  std::string robot;                               ///< empty for a stored map
  std::uint32_t group = 0;                         ///< number of its first part
  std::map<std::uint32_t, Meeting> meetings = {};  ///< with other groups, by number
  std::vector<MapPointer> last = {};               ///< newest stops, oldest first
};

class RobotParts {
 public:
  /// Adds a part in a group of its own.
  RobotPart& add(MapPart part, const std::string& robot);
  /// Number of the next part.
  [[nodiscard]] std::uint32_t next() const { return next_; }

  /// In the order of their beginning.
  [[nodiscard]] const std::vector<std::unique_ptr<RobotPart>>& all() const { return parts_; }
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// Group of the first part: the map. Requires parts.
  [[nodiscard]] std::uint32_t root() const { return parts_.front()->group; }
  [[nodiscard]] std::set<std::uint32_t> groups() const;
  /// The parts of a group, except `without`.
  [[nodiscard]] std::vector<MapPart*> group(std::uint32_t number,
                                            const RobotPart* without = nullptr) const;
  /// The non-empty parts of a group, ordered by the ids of their first stops, not by arrival.
  [[nodiscard]] std::vector<RobotPart*> by_first_stop(std::uint32_t number) const;
  /// The part that receives the robot's stops, or null.
  [[nodiscard]] RobotPart* live(const std::string& robot) const;
  /// The part that contains the stop, or null.
  [[nodiscard]] RobotPart* part_of(const topomap::StopId& stop) const;
  /// Pose in the frame of its group.
  [[nodiscard]] std::optional<UncertainPose> pose_of(const topomap::StopId& stop) const;

  /// Ends a part: it gets no more stops. A group other than the map whose parts have all ended is
  /// dropped, because it will never join.
  void end(RobotPart& part);
  /// Merges two groups, `moved` into the frame of `kept`. Returns the parts of `moved`.
  std::vector<RobotPart*> unite(std::uint32_t kept, std::uint32_t moved,
                                const geometry::Pose2& T_kept_moved);

  /// The parts of a group that have ended.
  [[nodiscard]] std::vector<MapPart*> over(std::uint32_t number) const;
  /// Replaces these parts by one: `map`, all their stops part by part with the measurements between
  /// them, reduced to the kept views. Links to a dropped view are moved to the view that stands for
  /// it.
  void replace_over(std::uint32_t number, const StoredMap& map, const KeptViews& kept);

  /// False if the two stops were linked before.
  bool link(const Sighting& sighting);
  void link(const PartLink& link) { links_.push_back(link); }
  /// Removes the matches of this stop with others, except the outvoted ones.
  void unlink(const topomap::StopId& stop);
  /// Removes the matches that contradict the poses of the joint optimisation. They are not added
  /// again.
  void drop_outvoted_links();
  [[nodiscard]] std::span<const PartLink> links() const { return links_; }

  /// Sum over all parts and meetings, including former ones.
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

/// Total number of stops.
std::size_t stops_of(std::span<MapPart* const> parts);

}  // namespace topogeo::localization
