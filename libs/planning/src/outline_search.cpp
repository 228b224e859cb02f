#include "outline_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <unordered_map>
#include <utility>

#include "arc_paths.hpp"

namespace topogeo::planning {
namespace {

constexpr int kTurns = 24;                   // headings of a base that turns on the spot
constexpr int kBends = 48;                   // and of one that drives arcs; less than 64
constexpr double kCell_m = 0.1;              // of positions that count as one
constexpr double kEager = 1.3;               // weight of the estimate
constexpr std::size_t kMostPoses = 500'000;  // some seconds, and 80 MB
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Length of the shortest path of the centre from every cell to the goal, metres.
class CentreDistance {
 public:
  CentreDistance(const OutlineField& field, double least_m, const Eigen::Vector2d& start_m,
                 const Eigen::Vector2d& goal_m)
      : frame_(field.frame()), length_m_(frame_.size(), kFar_m) {
    const auto goal = frame_.cell_of(goal_m);
    if (!goal) return;
    const auto open = [&](const Cell& cell) {
      if (field.distance_m(frame_.index(cell)) >= least_m) return true;
      constexpr double kAtEnds_m = 0.8;
      const Eigen::Vector2d middle_m = frame_.center_m(cell);
      return (middle_m - start_m).norm() < kAtEnds_m || (middle_m - goal_m).norm() < kAtEnds_m;
    };
    using Entry = std::pair<float, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    length_m_[frame_.index(*goal)] = 0.0F;
    queue.emplace(0.0F, frame_.index(*goal));
    while (!queue.empty()) {
      const auto [length_m, index] = queue.top();
      queue.pop();
      if (length_m > length_m_[index]) continue;
      const Cell cell = frame_.cell_at(index);
      for (std::int32_t row = -1; row <= 1; ++row) {
        for (std::int32_t column = -1; column <= 1; ++column) {
          const Cell next{cell.column + column, cell.row + row};
          if (!frame_.contains(next) || !open(next)) continue;
          const double step = row != 0 && column != 0 ? std::numbers::sqrt2 : 1.0;
          const float total_m = length_m + static_cast<float>(step * frame_.resolution_m);
          float& known_m = length_m_[frame_.index(next)];
          if (total_m >= known_m) continue;
          known_m = total_m;
          queue.emplace(total_m, frame_.index(next));
        }
      }
    }
  }

  [[nodiscard]] double from_m(const Eigen::Vector2d& point_m) const {
    const auto cell = frame_.cell_of(point_m);
    return cell ? double{length_m_[frame_.index(*cell)]} : double{kFar_m};
  }
  static constexpr float kFar_m = 1e6F;

 private:
  GridFrame frame_;
  std::vector<float> length_m_;
};

struct Visit {
  geometry::Pose2 pose;
  double cost = 0.0;
  std::uint32_t before = kNone;
  OutlineMove move;
};

class Search {
 public:
  Search(const OutlineField& field, const OutlineMoves& moves, const OutlineConfig& config,
         const geometry::Pose2& start, const PoseGoal& goal)
      : field_(field),
        moves_(moves),
        pieces_(moves.pieces()),
        headings_(moves.arc_radius_m() > 0.0 ? kBends : kTurns),
        goal_(goal),
        rest_(field,
              geometry::inscribed_radius_m(config.footprint) + config.margin_m -
                  field.frame().resolution_m,
              start.position_m(), goal.position_m) {
    if (reaches(start)) push({start, 0.0, kNone, {}});
  }

  std::optional<std::vector<OutlineMove>> run() {
    while (!queue_.empty() && visits_.size() < kMostPoses) {
      const auto [rank, index] = queue_.top();
      queue_.pop();
      if (const auto link = links_.find(index);
          link != links_.end() && rank == link->second.first) {
        return path_to(index, link->second.second);
      }
      const Visit here = visits_[index];
      if (best_[key_of(here.pose)] < here.cost) continue;
      if (!closed_.insert({key_of(here.pose), true}).second) continue;
      expand(index, here);
      try_link(index, here);
    }
    return std::nullopt;
  }

 private:
  using Entry = std::pair<double, std::uint32_t>;

  [[nodiscard]] bool reaches(const geometry::Pose2& pose) const {
    return rest_.from_m(pose.position_m()) < CentreDistance::kFar_m;
  }

  /// Estimate of the rest of the path, metres. Near a goal with a heading the bends count.
  [[nodiscard]] double estimate_m(const geometry::Pose2& pose) const {
    constexpr double kNear_m = 5.0;  // farther away, bends at the end hardly matter
    const double middle_m = rest_.from_m(pose.position_m());
    if (moves_.arc_radius_m() == 0.0 || !goal_.heading_rad || middle_m > kNear_m) return middle_m;
    const geometry::Pose2 end{goal_.position_m.x(), goal_.position_m.y(), *goal_.heading_rad};
    return std::max(middle_m, shortest_arcs_m(pose, end, moves_.arc_radius_m()));
  }

  [[nodiscard]] std::uint64_t key_of(const geometry::Pose2& pose) {
    const auto bin = [](double value) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value)) + (1 << 26));
    };
    const double step_rad = 2.0 * std::numbers::pi / headings_;
    const std::int64_t turn =
        static_cast<std::int64_t>(std::floor(pose.theta_rad / step_rad + 0.5)) + headings_;
    const auto turns = static_cast<std::uint64_t>(turn % headings_);
    return (bin(pose.x_m / kCell_m) << 34U) | (bin(pose.y_m / kCell_m) << 6U) | turns;
  }

  void push(const Visit& visit) {
    const std::uint64_t key = key_of(visit.pose);
    const auto [known, is_new] = best_.try_emplace(key, visit.cost);
    if (!is_new) {
      if (visit.cost >= known->second) return;
      known->second = visit.cost;
    }
    const auto index = static_cast<std::uint32_t>(visits_.size());
    visits_.push_back(visit);
    queue_.emplace(visit.cost + kEager * estimate_m(visit.pose), index);
  }

  void expand(std::uint32_t index, const Visit& here) {
    for (const OutlineMove& move : pieces_) {
      const geometry::Pose2 next = after(here.pose, move);
      if (!reaches(next)) continue;
      const auto closed = closed_.find(key_of(next));
      if (closed != closed_.end()) continue;
      const double price = moves_.cost(here.pose, move);
      if (price == OutlineMoves::kNever) continue;
      push({next, here.cost + price + stop_before(here, move), index, move});
    }
  }

  // Each change between ahead, back and turning is a stop.
  [[nodiscard]] static double stop_before(const Visit& here, const OutlineMove& move) {
    if (here.before == kNone) return 0.0;
    const bool turns = move.turn_rad != 0.0;
    if (turns) {
      return here.move.turn_rad * move.turn_rad > 0.0 ? 0.0 : OutlineMoves::kStop;
    }
    return here.move.length_m * move.length_m < 0.0 ? OutlineMoves::kStop : 0.0;
  }

  void try_link(std::uint32_t index, const Visit& here) {
    constexpr double kSight_m = 6.0;
    constexpr double kNear_m = 1.0;
    constexpr std::uint64_t kEvery = 4;
    const double away_m = (here.pose.position_m() - goal_.position_m).norm();
    const double rest_m = rest_.from_m(here.pose.position_m());
    constexpr double kRound = 1.15;  // a longer path of the centre goes round something
    if (away_m > kSight_m || rest_m > kRound * away_m + 0.2) return;
    if (away_m > kNear_m && tried_++ % kEvery != 0) return;
    auto link = moves_.link(here.pose, goal_.position_m, goal_.heading_rad);
    if (!link) return;
    double rank = here.cost + link->cost;
    if (here.before != kNone && !link->moves.empty()) {
      rank += moves_.reversal(here.move, link->moves.front());
    }
    links_.emplace(index, std::pair(rank, std::move(link->moves)));
    queue_.emplace(rank, index);
  }

  [[nodiscard]] std::vector<OutlineMove> path_to(std::uint32_t index,
                                                 const std::vector<OutlineMove>& last) const {
    std::vector<OutlineMove> path(last.rbegin(), last.rend());
    for (; visits_[index].before != kNone; index = visits_[index].before) {
      path.push_back(visits_[index].move);
    }
    std::ranges::reverse(path);
    return path;
  }

  const OutlineField& field_;
  const OutlineMoves& moves_;
  std::vector<OutlineMove> pieces_;
  int headings_;
  const PoseGoal& goal_;
  CentreDistance rest_;
  std::vector<Visit> visits_;
  std::unordered_map<std::uint64_t, double> best_;
  std::unordered_map<std::uint64_t, bool> closed_;
  std::unordered_map<std::uint32_t, std::pair<double, std::vector<OutlineMove>>> links_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::uint64_t tried_ = 0;
};

/// Joins successive turns, and successive pieces in one direction with one curvature.
std::vector<OutlineMove> joined(const std::vector<OutlineMove>& path) {
  std::vector<OutlineMove> joined;
  for (const OutlineMove& move : path) {
    if (joined.empty()) {
      joined.push_back(move);
      continue;
    }
    OutlineMove& last = joined.back();
    if (last.length_m == 0.0) {
      last.turn_rad += move.turn_rad;
      last.length_m = move.length_m;
      last.curvature_per_m = move.curvature_per_m;
    } else if (move.turn_rad == 0.0 && last.length_m * move.length_m > 0.0 &&
               last.curvature_per_m == move.curvature_per_m) {
      last.length_m += move.length_m;
    } else {
      joined.push_back(move);
    }
  }
  return joined;
}

double price_of(const OutlineMoves& moves, const geometry::Pose2& from, const OutlineMove& move) {
  return moves.cost(from, move) + (std::fabs(move.turn_rad) > 1e-6 ? OutlineMoves::kStop : 0.0);
}

}  // namespace

std::optional<std::vector<OutlineMove>> search_moves(const OutlineField& field,
                                                     const OutlineMoves& moves,
                                                     const OutlineConfig& config,
                                                     const geometry::Pose2& start,
                                                     const PoseGoal& goal) {
  return Search(field, moves, config, start, goal).run();
}

std::vector<OutlineMove> shortened(const OutlineMoves& moves, const geometry::Pose2& start,
                                   const PoseGoal& goal, std::vector<OutlineMove> path) {
  constexpr std::size_t kAhead = 12;  // moves that one link may replace
  path = joined(path);
  std::vector<geometry::Pose2> poses{start};
  for (const OutlineMove& move : path) poses.push_back(after(poses.back(), move));
  std::vector<OutlineMove> shorter;
  for (std::size_t i = 0; i < path.size();) {
    std::size_t next = i + 1;
    std::vector<OutlineMove> chosen{path[i]};
    double replaced = price_of(moves, poses[i], path[i]);
    const auto stops_around = [&](const std::vector<OutlineMove>& part, std::size_t then) {
      double stops = 0.0;
      if (!shorter.empty()) stops += moves.reversal(shorter.back(), part.front());
      if (then < path.size()) stops += moves.reversal(part.back(), path[then]);
      return stops;
    };
    for (std::size_t j = i + 1; j < std::min(path.size(), i + kAhead); ++j) {
      replaced += price_of(moves, poses[j], path[j]) + moves.reversal(path[j - 1], path[j]);
      const bool last = j + 1 == path.size();
      const auto heading_rad = last ? goal.heading_rad : std::optional(poses[j + 1].theta_rad);
      const auto link = moves.link(poses[i], poses[j + 1].position_m(), heading_rad);
      if (!link) continue;
      if (!link->moves.empty()) {
        const double stops = stops_around({path[i], path[j]}, j + 1);
        if (link->cost + stops_around(link->moves, j + 1) > replaced + stops) continue;
      } else if (link->cost > replaced) {
        continue;
      }
      chosen = link->moves;
      next = j + 1;
    }
    shorter.insert(shorter.end(), chosen.begin(), chosen.end());
    i = next;
  }
  return joined(shorter);
}

}  // namespace topogeo::planning
