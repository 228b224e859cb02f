#include "topogeo/relocalization/global_localization.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// These depend on each other and on the time limit of a search (benchmark relocalize/csail), so
// none is a setting.
constexpr double kThinned_m = 0.05;      // of the map's points
constexpr double kRobotRadius_m = 0.20;  // no scan comes from nearer to a wall
constexpr double kSeenFree_m = 8.0;      // a scan comes from at most this far from a stop
constexpr std::size_t kAligned = 8;      // best climbed places to align point to line
constexpr double kNearStop_m = 6.0;      // a stored stop this near has most of the same view
// Limits for a point of a scan, as for windows of places (PlaceRecognition): distance from a
// surface of the map, and distance by which a stop saw past it.
constexpr double kKnownWithin_m = 0.20;
constexpr double kSeenPast_m = 0.35;

// The answer to one scan. The limits were chosen on logs with known poses (tests/bench,
// topogeo_global_localization) so that no wrong place is accepted.
constexpr std::size_t kPosesWanted =
    5;  // distinct ones; the second shows whether the first is sure
constexpr double kSmallestFitness = 0.60;  // a pose with less is rejected
constexpr double kLargestDoubt = 2.2;      // and one with more, as by `gate.largest_doubt`
constexpr double kLargestRivalry =
    0.85;  // fitness of the best pose elsewhere over that of the best
constexpr std::size_t kFewestQueryPoints = 25;  // of the scan, thinned; fewer prove nothing

/// Value of the fine field at this distance from a point, which must be less than its width.
int occupied_within(double distance_m) {
  const double u =
      1.0 - distance_m * distance_m / (PlaceField::kFineWidth_m * PlaceField::kFineWidth_m);
  return static_cast<int>(255.0 * u * u);
}

/// About `count` points at most, spread over the scan.
std::vector<SurfacePoint> spread(const std::vector<SurfacePoint>& points, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, (points.size() + count - 1) / count);
  std::vector<SurfacePoint> out;
  for (std::size_t i = 0; i < points.size(); i += stride) out.push_back(points[i]);
  return out;
}

std::vector<Eigen::Vector2d> positions_of(const std::vector<SurfacePoint>& points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const SurfacePoint& point : points) out.push_back(point.position_m);
  return out;
}

/// One point per square of kThinned_m, in order.
std::vector<Eigen::Vector2d> thinned(std::vector<Eigen::Vector2d> points_m) {
  struct Entry {
    std::int64_t column;
    std::int64_t row;
    std::size_t index;
  };
  std::vector<Entry> entries;
  entries.reserve(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    entries.push_back({static_cast<std::int64_t>(std::floor(points_m[i].x() / kThinned_m)),
                       static_cast<std::int64_t>(std::floor(points_m[i].y() / kThinned_m)), i});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.row, a.column, a.index) < std::tie(b.row, b.column, b.index);
  });
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i > 0 && entries[i].row == entries[i - 1].row &&
        entries[i].column == entries[i - 1].column) {
      continue;
    }
    out.push_back(points_m[entries[i].index]);
  }
  return out;
}

/// Points rounded as for transmission, so that the field is the same everywhere.
std::vector<topomap::ScanPoint> as_sent(const std::vector<Eigen::Vector2d>& points_m) {
  std::vector<topomap::ScanPoint> out;
  out.reserve(points_m.size());
  for (const Eigen::Vector2d& p : points_m) {
    out.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
  }
  return out;
}

std::vector<Eigen::Vector2d> map_points(std::span<const topomap::LocalMap> maps,
                                        const topomap::Trajectory& trajectory) {
  std::vector<Eigen::Vector2d> points_m;
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    const Pose2& T = trajectory.stops[i].T_map_robot;
    const geometry::SinCos r = geometry::sincos(T.theta_rad);
    for (const topomap::ScanPoint& p : maps[i].points) {
      const Eigen::Vector2d q(p.x_m, p.y_m);
      points_m.emplace_back(T.x_m + r.cos * q.x() - r.sin * q.y(),
                            T.y_m + r.sin * q.x() + r.cos * q.y());
    }
  }
  return points_m;
}

/// Number of points of a robot at that pose in view of a stop; 0 unless more than `most`.
std::size_t points_seen(const StoredStop& stop, std::span<const SurfacePoint> points,
                        const Pose2& T_map_robot, std::size_t most) {
  const Pose2 T = geometry::between(stop.T_map_robot, T_map_robot);
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  std::size_t seen = points.size();
  for (const SurfacePoint& point : points) {
    const SurfacePoint p = moved(point, T, r);
    const auto view = stop.profile.view_of_face(p.position_m, p.normal, 0.4);
    if (view == RangeProfile::View::kFree || view == RangeProfile::View::kSurface) continue;
    if (--seen <= most) return 0;
  }
  return seen;
}

}  // namespace

bool same_global_place(const Pose2& a, const Pose2& b) {
  constexpr double kApart_m = 0.5;
  constexpr double kApart_rad = 0.2617993878;
  return (a.position_m() - b.position_m()).squaredNorm() < kApart_m * kApart_m &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) < kApart_rad;
}

GlobalLocalizer::GlobalLocalizer(std::span<const topomap::LocalMap> maps,
                                 const topomap::Trajectory& trajectory)
    : maps_(maps) {
  if (trajectory.stops.empty() || maps.size() < trajectory.stops.size()) {
    throw std::invalid_argument("global localization: " + std::to_string(maps.size()) +
                                " local maps for " + std::to_string(trajectory.stops.size()) +
                                " stops, expected at least one stop and a map for each");
  }
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    stops_.push_back({maps[i].id, trajectory.stops[i].T_map_robot,
                      RangeProfile(maps[i].points, maps[i].T_robot_laser)});
  }
  const std::vector<Eigen::Vector2d> points_m = thinned(map_points(maps, trajectory));
  if (points_m.empty()) {
    throw std::invalid_argument("global localization: no stop of the map has scan points");
  }
  // The margin is the longest range in the map.
  double longest_m = 0.0;
  for (const topomap::LocalMap& map : maps) {
    for (const topomap::ScanPoint& p : map.points) {
      longest_m = std::max(longest_m, std::sqrt(double{p.x_m} * p.x_m + double{p.y_m} * p.y_m));
    }
  }
  auto field = std::make_shared<PlaceField>(as_sent(points_m), longest_m + 1.0);
  field->set_free(free_cells(*field));
  field_ = std::move(field);
}

// Cells that a stop saw free and that have room for a robot.
std::vector<std::uint8_t> GlobalLocalizer::free_cells(const PlaceField& field) const {
  const KernelGrid& grid = field.grid();
  const auto columns = static_cast<std::size_t>(grid.columns());
  std::vector<std::uint8_t> free(columns * static_cast<std::size_t>(grid.rows()), 0);
  const int occupied = occupied_within(kRobotRadius_m);  // for the circle of the robot
  for (const StoredStop& stop : stops_) {
    const int reach = static_cast<int>(kSeenFree_m / grid.cell_m());
    const int c = grid.column(stop.T_map_robot.x_m);
    const int r = grid.row(stop.T_map_robot.y_m);
    const Pose2 T_robot_map = geometry::inverse(stop.T_map_robot);
    const geometry::SinCos turn = geometry::sincos(T_robot_map.theta_rad);
    for (int y = std::max(0, r - reach); y <= std::min(grid.rows() - 1, r + reach); ++y) {
      for (int x = std::max(0, c - reach); x <= std::min(grid.columns() - 1, c + reach); ++x) {
        std::uint8_t& cell =
            free[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)];
        if (cell != 0) continue;
        const Eigen::Vector2d p = grid.centre_m(x, y);
        const Eigen::Vector2d q(T_robot_map.x_m + turn.cos * p.x() - turn.sin * p.y(),
                                T_robot_map.y_m + turn.sin * p.x() + turn.cos * p.y());
        const bool here = std::abs(x - c) <= 1 && std::abs(y - r) <= 1;
        if (!here && stop.profile.view(q, kRobotRadius_m) != RangeProfile::View::kFree) continue;
        if (here || field.fine().at(p.x(), p.y()) < occupied) cell = 1;
      }
    }
  }
  return free;
}

std::vector<std::shared_ptr<const PlaceQuestion>> GlobalLocalizer::questions(
    const std::vector<SurfacePoint>& seen) const {
  return field_->questions(positions_of(spread(seen, PlaceField::kPoints)));
}

std::vector<Climbed> GlobalLocalizer::distinct(std::vector<MatchSolution> places,
                                               std::size_t count) {
  std::stable_sort(
      places.begin(), places.end(),
      [](const MatchSolution& a, const MatchSolution& b) { return a.fitness > b.fitness; });
  std::vector<Climbed> best;
  for (const MatchSolution& place : places) {
    if (best.size() == count) break;
    const bool known = std::any_of(best.begin(), best.end(), [&](const Climbed& other) {
      return same_global_place(other.T_map_robot, place.T_reference_query);
    });
    if (!known) best.push_back({place.T_reference_query, place.fitness});
  }
  return best;
}

// Nearest stops first: among equals the nearest wins, and mostly no other stop needs a full count.
std::size_t GlobalLocalizer::best_stop(const MatchFeatures& query, const Pose2& T_map_robot,
                                       double& share) const {
  const std::vector<SurfacePoint> outline = spread(query.coarse, 40);
  std::pair<double, std::size_t> nearest{std::numeric_limits<double>::infinity(), 0};
  std::vector<std::pair<double, std::size_t>> near;  // distance squared, stop
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const double apart_m2 =
        (stops_[i].T_map_robot.position_m() - T_map_robot.position_m()).squaredNorm();
    nearest = std::min(nearest, {apart_m2, i});
    if (apart_m2 <= kNearStop_m * kNearStop_m) near.emplace_back(apart_m2, i);
  }
  std::sort(near.begin(), near.end());
  std::size_t best = nearest.second;
  std::size_t most = 0;
  for (const auto& [apart_m2, i] : near) {
    if (most == outline.size()) break;
    const std::size_t seen = points_seen(stops_[i], outline, T_map_robot, most);
    if (seen <= most) continue;
    best = i;
    most = seen;
  }
  share = outline.empty() ? 0.0 : static_cast<double>(most) / static_cast<double>(outline.size());
  return best;
}

KnownView GlobalLocalizer::known_view(const MatchFeatures& query, const Pose2& T_map_robot) const {
  KnownView view;
  if (query.coarse.empty()) return view;
  const geometry::SinCos heading = geometry::sincos(T_map_robot.theta_rad);
  const double each = 1.0 / static_cast<double>(query.coarse.size());
  for (const SurfacePoint& point : query.coarse) {
    const SurfacePoint p = moved(point, T_map_robot, heading);
    if (field_->fine().at(p.position_m.x(), p.position_m.y()) >= occupied_within(kKnownWithin_m)) {
      view.there += each;
      continue;
    }
    const bool seen_past = std::any_of(stops_.begin(), stops_.end(), [&](const StoredStop& stop) {
      if ((stop.T_map_robot.position_m() - p.position_m).squaredNorm() >
          kSeenFree_m * kSeenFree_m) {
        return false;
      }
      const Pose2 T_stop_map = geometry::inverse(stop.T_map_robot);
      const SurfacePoint q = moved(p, T_stop_map, geometry::sincos(T_stop_map.theta_rad));
      return stop.profile.view_of_face(q.position_m, q.normal, kSeenPast_m) ==
             RangeProfile::View::kFree;
    });
    if (seen_past) view.contradicted += each;
  }
  return view;
}

double GlobalLocalizer::fitness(const MatchFeatures& query, const Pose2& T_map_robot) const {
  return mean_kernel(field_->fine(), positions_of(query.coarse), T_map_robot);
}

// Aligns a place with the stop that sees it best, and measures the evidence there.
GlobalPose GlobalLocalizer::aligned(const MatchFeatures& query, const Climbed& place) const {
  double share = 0.0;
  const std::size_t stop = best_stop(query, place.T_map_robot, share);
  const topomap::LocalMap& map = maps_[stop];
  const Reference reference = make_reference(extract_scan_features(map.points, map.T_robot_laser));
  const Pose2 T_start = geometry::between(stops_[stop].T_map_robot, place.T_map_robot);
  // A weak prior at the start: along a corridor nothing else holds the pose.
  const PosePrior prior{T_start, Eigen::Vector3d(25.0, 25.0, 100.0).asDiagonal()};
  const Refinement refined = refine(reference, query, T_start, prior);
  MatchResult evidence;
  evidence.violations = refined.violations;
  evidence.inliers = refined.inliers;
  evidence.residual_rms_m = refined.residual_rms_m;
  GlobalPose pose;
  pose.T_map_robot = stops_[stop].T_map_robot * refined.T_reference_query;
  pose.fitness = fitness(query, pose.T_map_robot);
  // If the two scans have little in common, the field of all stops is more reliable.
  if (pose.fitness < place.value) {
    const double climbed = fitness(query, place.T_map_robot);
    if (climbed > pose.fitness + 0.02) {
      pose.T_map_robot = place.T_map_robot;
      pose.fitness = climbed;
    }
  }
  evidence.scan_fitness = pose.fitness;
  pose.inliers = refined.inliers;
  pose.violations = refined.violations;
  pose.doubt = doubt(evidence);
  pose.stop = stops_[stop].id;
  const Eigen::Matrix3d in_stop = match_covariance(refined.information, pose.doubt);
  const geometry::SinCos r = geometry::sincos(stops_[stop].T_map_robot.theta_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << r.cos, -r.sin, r.sin, r.cos;
  pose.covariance = turn * in_stop * turn.transpose();
  return pose;
}

GlobalAnswer GlobalLocalizer::find(std::span<const topomap::ScanPoint> points,
                                   const Pose2& T_robot_laser) const {
  GlobalAnswer answer;
  const MatchFeatures query = extract_scan_features(points, T_robot_laser);
  if (query.coarse.size() < kFewestQueryPoints) return answer;
  std::vector<MatchSolution> places;
  for (const auto& question : questions(query.coarse)) {
    const std::vector<MatchSolution> some = field_->answer(*question);
    places.insert(places.end(), some.begin(), some.end());
  }
  std::vector<GlobalPose> found;
  for (const Climbed& place : distinct(std::move(places), kAligned)) {
    found.push_back(aligned(query, place));
  }
  const auto value = [](const GlobalPose& p) {
    return p.fitness * std::max(0.1, 1.0 - p.violations);
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const GlobalPose& a, const GlobalPose& b) { return value(a) > value(b); });
  for (const GlobalPose& pose : found) {
    if (answer.poses.size() == kPosesWanted) break;
    const bool known =
        std::any_of(answer.poses.begin(), answer.poses.end(), [&](const GlobalPose& other) {
          return same_global_place(other.T_map_robot, pose.T_map_robot);
        });
    if (!known) answer.poses.push_back(pose);
  }
  if (answer.poses.empty()) return answer;
  const GlobalPose& best = answer.poses.front();
  if (answer.poses.size() > 1) answer.rivalry = value(answer.poses[1]) / value(best);
  if (best.fitness < kSmallestFitness || best.doubt > kLargestDoubt) {
    answer.verdict = Verdict::kRejected;
  } else {
    answer.verdict = answer.rivalry > kLargestRivalry ? Verdict::kAmbiguous : Verdict::kAccepted;
  }
  return answer;
}

}  // namespace topogeo::localization
