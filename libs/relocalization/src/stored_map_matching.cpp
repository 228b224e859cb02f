#include "stored_map_matching.hpp"

#include <cmath>
#include <utility>

#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Stored stops further away are not compared: in a finished map nearer ones see the same.
constexpr double kFarthestStored_m = 12.0;
// Number of ids for the stops of a drive, reused in turn: the pool keeps no more of them. Tasks
// refer to the last three stops (DriveWindow); the others are a margin for answers that come late.
constexpr std::uint32_t kDriveIds = 64;

}  // namespace

StoredMapMatching::StoredMapMatching(const LocalizerConfig& config,
                                     std::shared_ptr<const StoredMap> map, MatchPool& pool)
    : config_(config),
      map_(std::move(map)),
      places_(map_->maps, map_->trajectory),
      requests_(config, pool),
      window_(requests_) {
  for (const topomap::LocalMap& local_map : map_->maps) {
    requests_.add_map(std::shared_ptr<const topomap::LocalMap>(map_, &local_map));
  }
  requests_.add_field(places_.field());
}

DriveStop StoredMapMatching::add(const topomap::LocalMap& map, std::uint32_t number,
                                 const std::optional<Pose2>& T_odom_last) {
  DriveStop stop;
  auto renumbered = std::make_shared<topomap::LocalMap>(map);
  renumbered->id = static_cast<std::uint32_t>(stored_stops()) + number % kDriveIds;
  stop.map = renumbered;
  requests_.add_map(stop.map);
  stop.features = extract_scan_features(map.points, map.T_robot_laser);
  std::optional<UncertainPose> odometry;
  if (T_odom_last) {
    odometry = odometry_between_stops(*T_odom_last, map, config_.odometry);
    stop.follows = true;
  }
  stop.step =
      window_.add(stop.map, std::make_shared<const StopView>(view_of(stop.features)), odometry);
  query_ = PlaceQuery(window_.seen(PlaceRecognition::kQuery_m));
  return stop;
}

std::vector<MatchCandidate> StoredMapMatching::candidates(const DriveStop& stop,
                                                          const UncertainPose& T_map_robot,
                                                          std::size_t count) const {
  const std::vector<SurfacePoint> outline = outline_of(stop.features.coarse);
  CandidateChoice choice(config_.smallest_expected_overlap);
  for (std::size_t i = 0; i < places_.stops().size(); ++i) {
    const StoredStop& stored = places_.stops()[i];
    const Pose2 T_stored_robot = geometry::between(stored.T_map_robot, T_map_robot.T_a_b);
    if (T_stored_robot.position_m().squaredNorm() > kFarthestStored_m * kFarthestStored_m) continue;
    choice.consider(static_cast<std::uint32_t>(i), stored.profile, outline,
                    {T_stored_robot, T_map_robot.covariance});
  }
  return choice.best_apart(count);
}

MatchTask StoredMapMatching::task(const DriveStop& stop, std::size_t stored,
                                  const UncertainPose& T_map_robot) {
  const UncertainPose T_map_stored{places_.stops()[stored].T_map_robot, Eigen::Matrix3d::Zero()};
  return requests_.make(stop.map->id, map_->maps[stored].id,
                        compose(inverse(T_map_robot), T_map_stored));
}

std::vector<Climbed> StoredMapMatching::search(const DriveStop& stop, std::size_t count) {
  return GlobalLocalizer::distinct(
      requests_.ask(places_.questions(query_.whole.surface), stop.map->id), count);
}

UncertainPose StoredMapMatching::measured(std::size_t stored, const MatchResult& result) const {
  const UncertainPose T_map_stored{places_.stops()[stored].T_map_robot, Eigen::Matrix3d::Zero()};
  return compose(T_map_stored, inverse(UncertainPose{result.T_reference_query,
                                                     honest_covariance(result, config_.evidence)}));
}

}  // namespace topogeo::localization
