// A part of a map that several robots make: the stops of one session as its own localizer holds
// them together, or what was stored before. Where it lies relative to the other parts comes from
// SharedMap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/session/mapping_session.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class MapPart {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// Begins with the next stop of a session, in a pool of its own.
  MapPart(std::uint32_t number, const LocalizerConfig& config, std::unique_ptr<MatchPool> pool);
  /// A stored map, to which no stop comes.
  MapPart(std::uint32_t number, const std::shared_ptr<const StoredMap>& stored);

  /// The next stop of the session; throws like MappingSession. The poses are those of the part
  /// alone, moved rigidly to where the part lies.
  void add(const MapPointer& map);
  /// Works off what is better done with all stops.
  void finish();
  /// No stop comes any more; what only mapping needs is freed.
  void end();
  /// Stops come, or may come.
  [[nodiscard]] bool goes_on() const { return session_ != nullptr; }

  /// Different for each part of a map; counts them.
  [[nodiscard]] std::uint32_t number() const { return number_; }
  [[nodiscard]] std::size_t size() const { return maps_.size(); }
  [[nodiscard]] const std::vector<MapPointer>& maps() const { return maps_; }
  /// As the part alone has them.
  [[nodiscard]] const topomap::Trajectory& own() const { return own_; }
  /// Between its stops, by their places here.
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const;
  /// Place of a stop here; none when it is not one of these.
  [[nodiscard]] std::optional<std::uint32_t> find(const topomap::StopId& stop) const;

  /// T_map_robot of each stop in the map of all parts.
  [[nodiscard]] const std::vector<UncertainPose>& poses() const { return poses_; }
  /// Puts them there; as many as stops.
  void place(std::vector<UncertainPose> poses) { poses_ = std::move(poses); }
  /// The same as the part alone has them.
  void place_as_own();
  /// Moves all of them.
  void move(const geometry::Pose2& T_new_old);
  /// The part alone has moved earlier stops, or has another number of them, since this was asked
  /// last.
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
  std::vector<PoseGraphEdge> edges_;  // once it has ended
  std::vector<UncertainPose> poses_;
  std::map<topomap::StopId, std::uint32_t> places_;
  SlamCounts counts_;  // once it has ended
  bool moved_ = false;
};

}  // namespace topogeo::localization
