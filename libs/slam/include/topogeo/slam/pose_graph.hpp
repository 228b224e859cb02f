// Poses of all stops and the relative poses measured between them. Least squares spreads a closed
// loop over them, which a discrete search cannot.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

// Poses of some stops relative to one of them: as many as a search along the graph reached.

class RelativePoses {
 public:
  struct Stop {
    std::uint32_t id = 0;
    UncertainPose T_origin_stop;
  };

  RelativePoses() = default;
  /// `stops`: ascending ids.
  explicit RelativePoses(std::vector<Stop> stops) : stops_(std::move(stops)) {}

  [[nodiscard]] std::span<const Stop> stops() const { return stops_; }
  /// Null for a stop that was not reached.
  [[nodiscard]] const UncertainPose* find(std::uint32_t id) const {
    const auto found =
        std::lower_bound(stops_.begin(), stops_.end(), id,
                         [](const Stop& stop, std::uint32_t wanted) { return stop.id < wanted; });
    return found != stops_.end() && found->id == id ? &found->T_origin_stop : nullptr;
  }
  /// Throws std::out_of_range for a stop that was not reached.
  [[nodiscard]] const UncertainPose& at(std::uint32_t id) const;

  /// Poses of the stops 0 to count - 1; one that was not reached is a thousand kilometres away.
  [[nodiscard]] std::vector<UncertainPose> by_id(std::size_t count) const;

  /// Adds to every covariance.
  void widen(const Eigen::Matrix3d& covariance) {
    for (Stop& stop : stops_) stop.T_origin_stop.covariance += covariance;
  }

 private:
  std::vector<Stop> stops_;
};

enum class EdgeKind : std::uint8_t {
  kOdometry = 0,
  kSequential = 1,  ///< match with a recent stop
  kRevisit = 2,     ///< match with a stop of an earlier visit: closes a loop
};

struct PoseGraphEdge {
  std::uint32_t from = 0;  ///< stop ids; from < to
  std::uint32_t to = 0;
  EdgeKind kind = EdgeKind::kOdometry;
  geometry::Pose2 T_from_to;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity();  ///< of T_from_to, in the frame of `from`; weight in the least
                                    ///< squares, with a margin for correlated errors of matches of
                                    ///< one place
  /// Covariance by measured errors (CovarianceCalibration), for predictions; zero: as `covariance`.
  Eigen::Matrix3d calibrated = Eigen::Matrix3d::Zero();

  [[nodiscard]] const Eigen::Matrix3d& for_predictions() const {
    return calibrated.isZero(0.0) ? covariance : calibrated;
  }
};

struct OptimizationSummary {
  bool usable = false;  ///< false: the poses are unchanged
  bool converged = false;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
};

class PoseLinks;
class StepSums;

class PoseGraph {
 public:
  PoseGraph();
  PoseGraph(const PoseGraph& other);
  /// A moved-from graph can only be assigned to or destroyed.
  PoseGraph(PoseGraph&&) noexcept;
  PoseGraph& operator=(const PoseGraph& other);
  PoseGraph& operator=(PoseGraph&&) noexcept;
  ~PoseGraph();

  /// Appends a stop; the first one never moves.
  std::uint32_t add_pose(const geometry::Pose2& T_map_robot);
  void add_edge(const PoseGraphEdge& edge);

  [[nodiscard]] const std::vector<geometry::Pose2>& poses() const { return poses_; }
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const { return edges_; }

  /// Indices of the edges that begin or end at a stop, ascending.
  [[nodiscard]] std::span<const std::uint32_t> edges_at(std::uint32_t stop) const {
    return edges_at_[stop];
  }

  /// Moves these stops (ascending) to optimised poses, and those after the last of them rigidly
  /// with it. Throws std::invalid_argument without stops, for an unknown stop or if the sizes
  /// differ.
  void move(std::span<const std::uint32_t> stops, std::span<const geometry::Pose2> T_map_robot);

  /// Squared Mahalanobis distance between an edge and the current poses.
  [[nodiscard]] double disagreement(const PoseGraphEdge& edge) const;

  /// Earlier stops with an edge to `stop`, each with the combined covariance of all edges between
  /// the two, in the frame of the earlier one.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> links_to(
      std::uint32_t stop) const;

  /// Places only the last pose, by the edges that end at it; the others are held.
  void place_last_pose();

  /// Least squares over all poses. Matches have a Cauchy loss, so that a wrong match that passed
  /// the gates bends the map a little instead of folding it. Single-threaded, so that results
  /// repeat.
  OptimizationSummary optimize();

  /// Replaces the measurement of the odometry step to a stop, which must have a predecessor; the
  /// covariances stay.
  void correct_step(std::uint32_t stop, const geometry::Pose2& T_before_stop);

  /// Removes all edges of the same kind between the same stops as one of these.
  void remove_edges(std::span<const PoseGraphEdge> like);

  /// The `most` stops before `end` that are nearest to a place, within a radius; ascending.
  [[nodiscard]] std::vector<std::uint32_t> stops_near(const Eigen::Vector2d& place_m,
                                                      double radius_m, std::size_t most,
                                                      std::uint32_t end) const;

  static constexpr std::size_t kAllStops = std::numeric_limits<std::size_t>::max();
  /// Visited stops in a prediction: all in a log of 4 km. In a longer one these are the nearest by
  /// path_cost(), and include the stops that see the place.
  static constexpr std::size_t kMostVisited = 4000;
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  /// Relative poses of the wanted stops (ascending) seen from `origin` with their covariances, each
  /// along the path of least variance. All edges between two stops are combined: along a bare
  /// corridor a match measures only the position across it, odometry the position along it. A stop
  /// is missing if it is not connected or its path_cost() exceeds `largest_cost`. The work is
  /// proportional to the stops that are no further away, by cost, than the wanted ones.
  [[nodiscard]] RelativePoses relative_to(std::uint32_t origin,
                                          std::span<const std::uint32_t> wanted,
                                          double largest_cost = kUnlimited) const;
  /// The same for all stops, by their ids. A stop that is not connected has a covariance of
  /// kUnreached_m2.
  [[nodiscard]] std::vector<UncertainPose> relative_to(std::uint32_t origin) const;
  static constexpr double kUnreached_m2 = 1e6;

  /// The same with the calibrated covariances of the edges: where to expect a stop. Matches of one
  /// place share errors that do not grow along a path, so these covariances are too small to weigh
  /// measurements against each other. At most `most` stops are visited, the nearest by cost, which
  /// bounds the work in a large graph whose stops are almost equally near; wanted stops beyond are
  /// missing.
  [[nodiscard]] RelativePoses predict_from(std::uint32_t origin,
                                           std::span<const std::uint32_t> wanted,
                                           double largest_cost = kUnlimited,
                                           std::size_t most = kAllStops) const;

  /// Visits stops in ascending order of path_cost() from the nearest of the origins, which must be
  /// distinct, until `visit` (stop, cost) returns false.
  void visit_nearest(std::span<const std::uint32_t> origins,
                     const std::function<bool(std::uint32_t, double)>& visit) const;

  /// Relative pose of two stops by the steps between them alone, ignoring all other edges;
  /// calibrated covariances, to first order. Constant time per 32 stops.
  [[nodiscard]] UncertainPose along_path(std::uint32_t from, std::uint32_t to) const;

  /// Length of a path with this covariance at its end, m^2: the position variance of things seen
  /// from there.
  static double path_cost(const Eigen::Matrix3d& covariance);

 private:
  void link(const PoseGraphEdge& edge);

  std::vector<geometry::Pose2> poses_;
  std::vector<PoseGraphEdge> edges_;
  std::vector<std::vector<std::uint32_t>> edges_at_;
  std::unique_ptr<PoseLinks> links_;
  std::unique_ptr<PoseLinks> calibrated_links_;
  std::unique_ptr<StepSums> step_sums_;  // filled on demand
};

}  // namespace topogeo::localization
