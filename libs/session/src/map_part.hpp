// A part of a map made by several robots: the stops of one session with a pose graph of
// their own, or a stored map. SharedMap places it relative to the other parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class MapPart {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// Begins with the next stop of a session, in its own pool.
  MapPart(std::uint32_t number, const LocalizerConfig& config, std::unique_ptr<MatchPool> pool);
  /// A stored map, which gets no more stops.
  MapPart(std::uint32_t number, const std::shared_ptr<const StoredMap>& stored);

  /// Adds the next stop of the session; throws like MappingSession. The poses are those of the part
  /// alone, moved rigidly to its place in the map.
  void add(const MapPointer& map);
  /// Does the work that is better done with all stops.
  void finish();
  /// Ends the session and frees everything that only mapping needs.
  void end();
  /// The session goes on: more stops may come.
  [[nodiscard]] bool goes_on() const { return session_ != nullptr; }

  /// Consecutive number, unique within a map.
  [[nodiscard]] std::uint32_t number() const { return number_; }
  [[nodiscard]] std::size_t size() const { return maps_.size(); }
  [[nodiscard]] const std::vector<MapPointer>& maps() const { return maps_; }
  /// The trajectory of the part alone.
  [[nodiscard]] const topomap::Trajectory& own() const { return own_; }
  /// Edges between its stops, by index.
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const;
  /// Index of a stop; empty if the part does not contain it.
  [[nodiscard]] std::optional<std::uint32_t> find(const topomap::StopId& stop) const;

  /// T_map_robot of each stop in the map of all parts.
  [[nodiscard]] const std::vector<UncertainPose>& poses() const { return poses_; }
  /// Sets these poses, one per stop.
  void place(std::vector<UncertainPose> poses) { poses_ = std::move(poses); }
  /// Uses the poses of the part alone.
  void place_as_own();
  /// Moves all poses.
  void move(const geometry::Pose2& T_new_old);
  /// Whether the part alone has moved earlier stops, or their number has changed, since the last
  /// call.
  bool take_moved() { return std::exchange(moved_, false); }

  [[nodiscard]] const MappingSession* session() const { return session_.get(); }
  [[nodiscard]] SlamCounts counts() const { return session_ ? session_->counts() : counts_; }

 private:
  void read_session();

  std::uint32_t number_;
  std::unique_ptr<MatchPool> pool_;
  std::unique_ptr<MappingSession> session_;
  std::vector<MapPointer> maps_;
  topomap::Trajectory own_;
  std::vector<PoseGraphEdge> edges_;  // after the end
  std::vector<UncertainPose> poses_;
  std::map<topomap::StopId, std::uint32_t> places_;
  SlamCounts counts_;  // after the end
  bool moved_ = false;
};

}  // namespace topogeo::localization
