// Mapping and localizing in turn: a map that is new or stored, extended by what the robot sees or
// left as it is while the robot is followed in it.
//
// Whenever the robot's place in the map is not known for certain, at the start of a stored map and
// after a time in which stops were not mapped, it is followed or searched for by a MapLocalizer.
// Its stops are kept meanwhile, and join the map together as soon as the last of them is tracked
// and matched there, after a search only some metres further; if that never happens the map
// stays as it was. When a drive joins, views of earlier drives leave the map that others show as
// well (KeptViews), so that a patrol does not make it grow. All of that follows from the stops
// alone, so one drive gives the same map wherever it is computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/session/kept_views.hpp"
#include "topogeo/localization/session/place_confirmation.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"

namespace topogeo::localization {

class MappingSession : public Slam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// A drive that does not find its place joins the map with so many stops, the newest ones.
  static constexpr std::size_t kMostWaiting = 1024;
  /// A drive that goes on and on counts as several, and views leave the map while it does.
  struct LongDrive {
    std::size_t stops = 4000;                      ///< of the map, before any view leaves it
    std::uint32_t stops_of_drive = kStopsOfDrive;  ///< of what counts as one drive
    std::size_t untouched = 100;  ///< stops where the robot is, and of loops under way
  };

  /// Begins an empty map. The pool and the optimizer must outlive the session.
  MappingSession(const LocalizerConfig& config, MatchPool& pool,
                 GraphOptimizer* optimizer = nullptr);
  /// Continues a stored map. `initial` is where the robot is at its first stop; without it the
  /// whole map is searched. Throws std::invalid_argument in LocalizerMode::kThesis, and like
  /// Localizer and MapLocalizer.
  MappingSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
                 std::shared_ptr<const StoredMap> map, const std::optional<UncertainPose>& initial);

  /// The drive goes on from the last stop of the stored map, which is one of its session. Before
  /// the first stop.
  void go_on();

  /// No view leaves the map, whatever others show.
  void keep_all_views() { keeps_all_ = true; }

  /// Other limits, before the first stop.
  void set_long_drive(const LongDrive& limits);

  /// The next stop of the drive. The numbers of a session count on from the first that comes,
  /// whatever becomes of its stops; throws std::invalid_argument otherwise, or when it is of
  /// another robot than the map. Another session is another drive, whose place in the map is
  /// searched for; stops of the one before that have not joined the map by then never will.
  bool add(MapPointer map) override;
  /// Leaves a map alone to which nothing was added.
  void finish() override;

  /// From the next stop on the map stays as it is. Throws std::logic_error when it does already or
  /// there is none yet, and like MapLocalizer. Stops that have not joined it by now never will.
  void stop_mapping();
  /// From the next stop on the map grows again. Throws std::logic_error when it does already,
  /// std::invalid_argument in LocalizerMode::kThesis.
  void resume_mapping();
  /// What was asked for: stops join the map, now or when their place is known.
  [[nodiscard]] bool mapping() const { return mapping_; }

  /// What follows the robot in the map; null while its stops become part of it one by one.
  [[nodiscard]] MapLocalizer* follower() const { return follower_.get(); }

  /// The map: its local maps, numbered on from 0, ...
  [[nodiscard]] const std::vector<MapPointer>& maps() const { return maps_; }
  /// ... their poses, each with the stop that its local map came as ...
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  /// ... how many of them were there at the start ...
  [[nodiscard]] std::size_t stored_stops() const { return stored_stops_; }
  /// ... and how many were added since, of which some may have left the map again.
  [[nodiscard]] std::size_t added_stops() const { return added_; }

  /// Stops of the drive that were not added: not wanted, or their place was not found.
  [[nodiscard]] std::size_t unmapped_stops() const { return stops_ - added_; }
  /// Of those, the ones that join it if the robot finds its place.
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
    return follower_ ? follower_->status() : mapper_->status();
  }
  [[nodiscard]] SlamCounts counts() const override;

 private:
  void begin_drive(const topomap::LocalMap& map);
  /// Makes it the map, with a mapper of its own.
  void take_map(const std::shared_ptr<const StoredMap>& map);
  [[nodiscard]] std::shared_ptr<const StoredMap> map_so_far() const;
  bool map_stop(const MapPointer& map);
  bool follow(const MapPointer& map);
  void join();
  /// Views that others show as well leave the map, but none of the last `untouched` ones. Returns
  /// what was kept of which stops, if any left.
  struct Renewed {
    std::shared_ptr<const StoredMap> before;
    KeptViews kept;
  };
  std::optional<Renewed> renew(std::size_t untouched);
  /// The matches as those of the stops that are kept.
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
  Localizer* localizer_ = nullptr;  // mapper_, unless that is the algorithm of the Thesis
  std::unique_ptr<MapLocalizer> follower_;
  bool mapping_ = true;
  std::optional<topomap::StopId> last_id_;  // of the drive
  std::size_t stops_ = 0;                   // that came
  std::vector<MapPointer> maps_;
  std::vector<topomap::StopPose> stands_for_;  // of each: which views it stands for, nothing else
  std::uint64_t numbered_since_ = 0;           // see topomap::Trajectory
  std::size_t stored_stops_ = 0;
  std::size_t added_ = 0;
  LongDrive long_drive_;
  std::size_t renew_at_ = long_drive_.stops;
  bool keeps_all_ = false;
  PlaceConfirmation confirmation_;   // of what the follower says
  std::vector<MapPointer> waiting_;  // to join the map, as they came
  SlamCounts counts_before_;         // of followers and mappers that have gone
};

}  // namespace topogeo::localization
