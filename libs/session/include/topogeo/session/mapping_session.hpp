// Mapping and localizing in turn: a new or stored map is extended by the robot's stops, or kept
// unchanged while the robot is followed in it.
//
// Whenever the robot's pose in the map is uncertain, at the start of a stored map and after
// unmapped stops, a MapTracker follows the robot or searches for it. Its stops wait meanwhile, and
// join the map together as soon as the last of them is tracked and matched there (after a search
// only some metres later). If that never happens, the map does not change. When a drive joins,
// views of earlier drives leave the map if other views show the same (KeptViews), so that a patrol
// does not make it grow. All of this follows from the stops alone, so a drive gives the same map
// wherever it is computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/kept_views.hpp"
#include "topogeo/session/place_confirmation.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/slam/stored_map.hpp"

namespace topogeo::localization {

class MappingSession : public Slam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// A drive whose pose is not found joins the map with at most this many stops, the newest ones.
  static constexpr std::size_t kMostWaiting = 1024;
  /// A drive that goes on and on counts as several, and views leave the map meanwhile.
  struct LongDrive {
    std::size_t stops = 4000;                      ///< of the map, before any view leaves it
    std::uint32_t stops_of_drive = kStopsOfDrive;  ///< length of what counts as one drive
    std::size_t untouched = 100;  ///< newest stops, needed by the robot and pending loops
  };

  /// Begins an empty map. The pool and the optimizer must outlive the session.
  MappingSession(const LocalizerConfig& config, MatchPool& pool,
                 GraphOptimizer* optimizer = nullptr);
  /// Continues a stored map. `initial` is the pose of the robot at its first stop; without it the
  /// whole map is searched. Throws std::invalid_argument in SlamAlgorithm::kThesis, and like
  /// PoseGraphSlam and MapTracker.
  MappingSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
                 std::shared_ptr<const StoredMap> map, const std::optional<UncertainPose>& initial);

  /// The drive continues from the last stop of the stored map, which belongs to its session. Call
  /// before the first stop.
  void resume_session();

  /// No view leaves the map, even if others show the same.
  void keep_all_views() { keeps_all_ = true; }

  /// Sets other limits; call before the first stop.
  void set_long_drive(const LongDrive& limits);

  /// Adds the next stop of the drive. The numbers of a session must be consecutive from its first
  /// stop, whether or not the stops are mapped; throws std::invalid_argument otherwise, or if the
  /// stop belongs to another robot than the map. Another session is another drive, whose pose in
  /// the map is searched; stops of the previous drive that are still waiting are discarded.
  bool add(MapPointer map) override;
  /// Does nothing to a map to which no stop was added.
  void finish() override;

  /// Keeps the map unchanged, starting with the next stop. Waiting stops are discarded. Throws
  /// std::logic_error if it is unchanged already or there is no map yet, and like MapTracker.
  void stop_mapping();
  /// Extends the map again, starting with the next stop. Throws std::logic_error if it is extended
  /// already, std::invalid_argument in SlamAlgorithm::kThesis.
  void resume_mapping();
  /// The requested mode: stops join the map, now or once their pose is known.
  [[nodiscard]] bool mapping() const { return mapping_; }

  /// Follows the robot in the map; null while its stops join the map one by one.
  [[nodiscard]] MapTracker* map_tracker() const { return map_tracker_.get(); }

  /// Local maps of the map, numbered from 0.
  [[nodiscard]] const std::vector<MapPointer>& maps() const { return maps_; }
  /// Their poses, each with the id under which its stop came.
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  /// Number of stops at the start.
  [[nodiscard]] std::size_t stored_stops() const { return stored_stops_; }
  /// Number of stops added since, some of which may have left the map again.
  [[nodiscard]] std::size_t added_stops() const { return added_; }

  /// Stops of the drive that were not added: not requested, or their pose was not found.
  [[nodiscard]] std::size_t unmapped_stops() const { return stops_ - added_; }
  /// Unmapped stops that join the map if the robot's pose is found.
  [[nodiscard]] std::size_t waiting_stops() const { return waiting_.size(); }
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;

  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override {
    return mapper_->loop_closures();
  }
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return mapper_->loop_decisions();
  }
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const override {
    return mapper_->edges();
  }
  [[nodiscard]] LocalizationStatus status() const override {
    return map_tracker_ ? map_tracker_->status() : mapper_->status();
  }
  [[nodiscard]] SlamCounts counts() const override;

 private:
  void begin_drive(const topomap::LocalMap& map);
  /// Replaces the map, with a new mapper.
  void take_map(const std::shared_ptr<const StoredMap>& map);
  [[nodiscard]] std::shared_ptr<const StoredMap> map_so_far() const;
  bool map_stop(const MapPointer& map);
  bool follow(const MapPointer& map);
  void join();
  /// Removes views that others show as well, but none of the last `untouched` ones. Returns the map
  /// before and the selection, if any view left.
  struct Renewed {
    std::shared_ptr<const StoredMap> before;
    KeptViews kept;
  };
  std::optional<Renewed> renew(std::size_t untouched);
  /// The matches, moved to the stops that are kept.
  [[nodiscard]] static std::vector<StoredMatch> renewed(std::vector<StoredMatch> matches,
                                                        const Renewed& by);
  void renew_long_drive();
  void add_to_map(MapPointer map);
  void start_following(std::shared_ptr<const StoredMap> map);
  void end_following();
  [[nodiscard]] MapPointer numbered(const MapPointer& map, bool starts_drive) const;

  LocalizerConfig config_;
  MatchPool& pool_;
  GraphOptimizer* optimizer_;
  std::unique_ptr<Slam> mapper_;
  PoseGraphSlam* pose_graph_slam_ = nullptr;  // mapper_; null for the algorithm of the Thesis
  std::unique_ptr<MapTracker> map_tracker_;
  bool mapping_ = true;
  std::optional<topomap::StopId> last_id_;  // of the drive
  std::size_t stops_ = 0;                   // received
  std::vector<MapPointer> maps_;
  std::vector<topomap::StopPose> stands_for_;  // only the view counts of each stop
  std::uint64_t numbered_since_ = 0;           // see topomap::Trajectory
  std::size_t stored_stops_ = 0;
  std::size_t added_ = 0;
  LongDrive long_drive_;
  std::size_t renew_at_ = long_drive_.stops;
  bool keeps_all_ = false;
  PlaceConfirmation confirmation_;   // of the tracker's pose
  std::vector<MapPointer> waiting_;  // to join the map, as received
  SlamCounts counts_before_;         // of earlier trackers and mappers
};

}  // namespace topogeo::localization
