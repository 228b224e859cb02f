#include "topogeo/exchange/align.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/relocalization/global_localization.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/support/check_range.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::exchange {
namespace {

using geometry::Pose2;

// Two poses of a stop agree within the largest error of global localization (same_global_place),
// and the final ones within that of aligned scans.
constexpr double kCoarse_m = 0.6;
constexpr double kCoarse_rad = 0.12;
constexpr double kFine_m = 0.3;
constexpr double kFine_rad = 0.06;
// Our map should show a stop if this much of its scan is within sight of a stop of ours, and the
// stop fits if this much of it lies on obstacles.
constexpr double kSeen = 0.6;
constexpr double kFits = 0.45;

/// The located stops with scan points.
storage::MapDocument usable_part(const storage::MapDocument& document, const char* what) {
  storage::MapDocument part;
  const auto& stops = document.trajectory.stops;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (!stops[i].located || document.local_maps[i].points.empty()) continue;
    part.local_maps.push_back(document.local_maps[i]);
    part.trajectory.stops.push_back(stops[i]);
    const auto id = static_cast<std::uint32_t>(part.local_maps.size() - 1);
    part.local_maps.back().id = part.trajectory.stops.back().local_map_id = id;
  }
  if (part.local_maps.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: expected stops with poses and scan points, got none", what));
  }
  return part;
}

struct SearchedStop {
  Pose2 T_foreign_robot;
  localization::MatchFeatures features;
  std::vector<localization::GlobalPose> answers;
};

bool agree(const Pose2& a, const Pose2& b, double most_m, double most_rad) {
  return (a.position_m() - b.position_m()).norm() <= most_m &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) <= most_rad;
}

class Aligner {
 public:
  /// The stops of both maps have poses and scan points.
  Aligner(const storage::MapDocument& map, const storage::MapDocument& foreign,
          const AlignSettings& settings)
      : settings_(settings),
        map_(map),
        foreign_(foreign),
        localizer_(map_.local_maps, map_.trajectory) {}

  Alignment align() {
    search_stops();
    Alignment out;
    out.searched = stops_.size();
    std::vector<Pose2> hypotheses;
    for (const SearchedStop& stop : stops_) {
      for (const localization::GlobalPose& answer : stop.answers) {
        hypotheses.push_back(answer.T_map_robot * geometry::inverse(stop.T_foreign_robot));
      }
    }
    if (hypotheses.empty()) {
      out.reason = "no stop of the smaller map matches the larger one";
      return out;
    }
    std::vector<double> support;
    support.reserve(hypotheses.size());
    for (const Pose2& T : hypotheses) support.push_back(support_of(T));
    const auto best = std::ranges::max_element(support);
    const Pose2& T_best = hypotheses[static_cast<std::size_t>(best - support.begin())];
    out.T_map_foreign = refined(T_best, out);
    double second = 0.0;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      if (!same_for_stops(hypotheses[i], out.T_map_foreign)) second = std::max(second, support[i]);
    }
    out.rivalry = *best > 0.0 ? second / *best : 1.0;
    verify(out);
    judge(out);
    return out;
  }

 private:
  void search_stops() {
    const std::size_t count = foreign_.local_maps.size();
    const std::size_t wanted = std::min(settings_.stops, count);
    for (std::size_t k = 0; k < wanted; ++k) {
      const std::size_t i = k * count / wanted;  // spread over all of them
      const topomap::LocalMap& local = foreign_.local_maps[i];
      stops_.push_back({foreign_.trajectory.stops[i].T_map_robot,
                        localization::extract_scan_features(local.points, local.T_robot_laser),
                        localizer_.find(local.points, local.T_robot_laser).poses});
    }
  }

  /// Sum of fitness of the answers that agree with a pose of the whole, the best of each stop.
  [[nodiscard]] double support_of(const Pose2& T_map_foreign) const {
    double sum = 0.0;
    for (const SearchedStop& stop : stops_) {
      const localization::GlobalPose* answer =
          answer_near(stop, T_map_foreign * stop.T_foreign_robot, kCoarse_m, kCoarse_rad);
      if (answer != nullptr) sum += answer->fitness * std::max(0.0, 1.0 - answer->violations);
    }
    return sum;
  }

  static const localization::GlobalPose* answer_near(const SearchedStop& stop, const Pose2& T,
                                                     double most_m, double most_rad) {
    for (const localization::GlobalPose& answer : stop.answers) {
      if (agree(answer.T_map_robot, T, most_m, most_rad)) return &answer;
    }
    return nullptr;
  }

  /// Whether both poses put all stops at the same places.
  [[nodiscard]] bool same_for_stops(const Pose2& a, const Pose2& b) const {
    return std::ranges::all_of(stops_, [&](const SearchedStop& stop) {
      return agree(a * stop.T_foreign_robot, b * stop.T_foreign_robot, 2.0 * kCoarse_m,
                   2.0 * kCoarse_rad);
    });
  }

  /// The pose that fits the agreeing stops best: least squares over their positions and headings,
  /// where a heading is weighted like a position at the lever below.
  Pose2 refined(Pose2 T, Alignment& out) const {
    constexpr double kLever_m = 2.0;
    constexpr int kRounds = 4;
    double most_m = kCoarse_m;
    double most_rad = kCoarse_rad;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<std::pair<Pose2, Pose2>> pairs;  // foreign, ours
      for (const SearchedStop& stop : stops_) {
        const auto* answer = answer_near(stop, T * stop.T_foreign_robot, most_m, most_rad);
        if (answer != nullptr) pairs.emplace_back(stop.T_foreign_robot, answer->T_map_robot);
      }
      out.agreeing = pairs.size();
      if (pairs.empty()) return T;
      Eigen::Vector2d middle_foreign = Eigen::Vector2d::Zero();
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const auto& [foreign, ours] : pairs) {
        middle_foreign += foreign.position_m() / static_cast<double>(pairs.size());
        middle += ours.position_m() / static_cast<double>(pairs.size());
      }
      double turn = 0.0;
      double weight = 0.0;
      const geometry::SinCos r = geometry::sincos(T.theta_rad);
      for (const auto& [foreign, ours] : pairs) {
        const Eigen::Vector2d d = foreign.position_m() - middle_foreign;
        const Eigen::Vector2d e = ours.position_m() - middle;
        const Eigen::Vector2d f(r.cos * d.x() - r.sin * d.y(), r.sin * d.x() + r.cos * d.y());
        const double across = f.x() * e.y() - f.y() * e.x();
        turn += across + kLever_m * kLever_m *
                             geometry::wrap_angle(ours.theta_rad - foreign.theta_rad - T.theta_rad);
        weight += f.dot(e) + kLever_m * kLever_m;
      }
      T.theta_rad = geometry::wrap_angle(T.theta_rad + turn / weight);
      const Pose2 turned{0.0, 0.0, T.theta_rad};
      const Eigen::Vector2d shift = middle - turned * middle_foreign;
      T.x_m = shift.x();
      T.y_m = shift.y();
      spread(T, pairs, out);
      most_m = kFine_m;
      most_rad = kFine_rad;
    }
    return T;
  }

  static void spread(const Pose2& T, const std::vector<std::pair<Pose2, Pose2>>& pairs,
                     Alignment& out) {
    double sum_m2 = 0.0;
    double sum_rad2 = 0.0;
    for (const auto& [foreign, ours] : pairs) {
      const Pose2 at = T * foreign;
      sum_m2 += (at.position_m() - ours.position_m()).squaredNorm();
      const double turn = geometry::wrap_angle(at.theta_rad - ours.theta_rad);
      sum_rad2 += turn * turn;
    }
    // Aligned scans share errors of a centimetre and a fifth of a degree, which do not average out.
    const double n = static_cast<double>(pairs.size());
    out.sigma_m = std::sqrt(1e-4 + sum_m2 / (n * n));
    out.sigma_rad = std::sqrt(1.2e-5 + sum_rad2 / (n * n));
  }

  /// Counts the foreign stops that our map should show, and those that fit.
  void verify(Alignment& out) const {
    for (const SearchedStop& stop : stops_) {
      const Pose2 T_map_robot = out.T_map_foreign * stop.T_foreign_robot;
      double share = 0.0;
      static_cast<void>(localizer_.best_stop(stop.features, T_map_robot, share));
      if (share < kSeen) continue;
      ++out.expected;
      if (localizer_.fitness(stop.features, T_map_robot) >= kFits) ++out.fitting;
    }
  }

  void judge(Alignment& out) const {
    const double share = out.expected == 0
                             ? 0.0
                             : static_cast<double>(out.fitting) / static_cast<double>(out.expected);
    out.confidence = share * (1.0 - std::min(1.0, out.rivalry)) *
                     std::min(1.0, static_cast<double>(out.agreeing) /
                                       (2.0 * static_cast<double>(settings_.least)));
    if (out.agreeing < std::min(settings_.least, stops_.size()) || out.agreeing < 2) {
      out.reason = fmt::format("only {} of {} stops agree on a pose, expected {}", out.agreeing,
                               stops_.size(), settings_.least);
    } else if (out.rivalry > settings_.most_rivalry) {
      out.reason = fmt::format("ambiguous: another pose has {:.0f} % of the support of the best",
                               100.0 * out.rivalry);
    } else if (share < settings_.least_share) {
      out.reason = fmt::format("{} of {} stops in the mapped area do not fit the map",
                               out.expected - out.fitting, out.expected);
    }
    out.found = out.reason.empty();
  }

  AlignSettings settings_;
  const storage::MapDocument& map_;
  const storage::MapDocument& foreign_;
  localization::GlobalLocalizer localizer_;
  std::vector<SearchedStop> stops_;
};

/// Diagonal of the box around all stops, metres.
double extent_m(const storage::MapDocument& document) {
  Eigen::AlignedBox2d box;
  for (const topomap::StopPose& stop : document.trajectory.stops) {
    box.extend(stop.T_map_robot.position_m());
  }
  return box.diagonal().norm();
}

}  // namespace

Alignment align(const storage::MapDocument& map, const storage::MapDocument& foreign,
                const AlignSettings& settings) {
  if (settings.stops < 4 || settings.stops > 1000) {
    throw std::invalid_argument(
        fmt::format("stops to search for: {}, expected 4 to 1000", settings.stops));
  }
  support::check_range("least share", settings.least_share, 0.0, 1.0);
  support::check_range("largest rivalry", settings.most_rivalry, 0.0, 1.0);
  const storage::MapDocument ours = usable_part(map, "the map");
  const storage::MapDocument theirs = usable_part(foreign, "the foreign map");
  if (extent_m(theirs) <= extent_m(ours)) return Aligner(ours, theirs, settings).align();
  Alignment alignment = Aligner(theirs, ours, settings).align();
  alignment.T_map_foreign = geometry::inverse(alignment.T_map_foreign);
  return alignment;
}

}  // namespace topogeo::exchange
