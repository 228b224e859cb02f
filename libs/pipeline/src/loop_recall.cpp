#include "topogeo/pipeline/loop_recall.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/support/format.hpp"

#include "nearest_pose.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using localization::LoopOutcome;
using storage::LoopCandidate;
using StopPair = std::pair<std::uint32_t, std::uint32_t>;
using ReferencePoses = std::vector<std::optional<Pose2>>;  // by local map id

// Fixed, so that tables of different versions can be compared.
constexpr std::uint32_t kRevisitStops = 30;
constexpr double kRevisit_m = 2.0;
constexpr double kRevisit_rad = 1.0;
constexpr double kRightMatch_m = 0.25;
constexpr double kRightMatch_rad = 0.09;
constexpr double kNearMatch_m = 0.6;
constexpr double kNearMatch_rad = 0.2;
// Limits that LoopCandidate::probability refers to.
constexpr double kProbable_m = 0.5;
constexpr double kProbable_rad = 0.174532925;

// Share of the later scan's points that the older stop must also see.
constexpr double kLeastInView = 0.5;
constexpr double kSame_m = 0.2;       // from its points, or across the outline between them
constexpr double kOutline_m = 0.6;    // largest distance between two points of an outline
constexpr double kSeenThere_m = 0.3;  // half-thickness of surfaces in view

struct LoopOffset {
  double distance_m = 0.0;
  double angle_rad = 0.0;

  [[nodiscard]] bool within(double limit_m, double limit_rad) const {
    return distance_m < limit_m && angle_rad < limit_rad;
  }
};

StopPair pair_of(const LoopCandidate& candidate) {
  return {candidate.earlier_id, candidate.later_id};
}

bool has_outcome(const LoopCandidate& candidate, LoopOutcome outcome) {
  return candidate.outcome == localization::to_string(outcome);
}

ReferencePoses reference_poses(std::span<const topomap::LocalMap> maps,
                               std::span<const topomap::StampedPose> reference,
                               std::int64_t max_apart_ns) {
  const std::vector<topomap::StampedPose> sorted = in_time_order(reference);
  ReferencePoses poses;
  poses.reserve(maps.size());
  for (const topomap::LocalMap& map : maps) {
    const topomap::StampedPose* pose = nearest_pose(sorted, map.stamp_ns, max_apart_ns);
    poses.push_back(pose == nullptr ? std::nullopt : std::optional(pose->pose));
  }
  return poses;
}

/// The relative pose of two stops by the reference.
std::optional<Pose2> between_stops(const ReferencePoses& poses, const StopPair& stops) {
  const std::optional<Pose2>& a = poses[stops.first];
  const std::optional<Pose2>& b = poses[stops.second];
  if (!a || !b) return std::nullopt;
  return geometry::between(*a, *b);
}

LoopOffset offset_of(const LoopCandidate& candidate, const Pose2& T_by_reference) {
  const Eigen::Vector3d error = geometry::difference(candidate.T_earlier_later, T_by_reference);
  return {error.head<2>().norm(), std::fabs(error.z())};
}

std::string outcome_text(const LoopCandidate& candidate) {
  const bool matched = candidate.reason == localization::to_string(localization::Reason::kNone);
  return matched ? candidate.outcome : candidate.outcome + ": " + candidate.reason;
}

/// The decisions that became loops and were not outvoted.
std::vector<const LoopCandidate*> loops_of(std::span<const LoopCandidate> candidates) {
  std::vector<const LoopCandidate*> loops;
  for (const LoopCandidate& candidate : candidates) {
    const bool accepted = has_outcome(candidate, LoopOutcome::kAccepted);
    if (!accepted && !has_outcome(candidate, LoopOutcome::kOutvoted)) continue;
    std::erase_if(loops,
                  [&](const LoopCandidate* loop) { return pair_of(*loop) == pair_of(candidate); });
    if (accepted) loops.push_back(&candidate);
  }
  return loops;
}

double in_common(const topomap::LocalMap& earlier, const topomap::LocalMap& later,
                 const Pose2& T_earlier_later) {
  const localization::Reference reference =
      localization::make_reference(localization::extract_features(earlier));
  const localization::PoseEvidence evidence =
      localization::evidence_at(reference, localization::extract_features(later), T_earlier_later);
  return evidence.overlap * (evidence.inliers - 2.0 * evidence.violations);
}

std::vector<LoopOffReference> loops_off_reference(std::span<const topomap::LocalMap> maps,
                                                  const ReferencePoses& poses,
                                                  std::span<const LoopCandidate* const> loops) {
  std::vector<LoopOffReference> off_reference;
  for (const LoopCandidate* loop : loops) {
    const std::optional<Pose2> T = between_stops(poses, pair_of(*loop));
    if (!T) continue;
    const LoopOffset offset = offset_of(*loop, *T);
    if (offset.within(kNearMatch_m, kNearMatch_rad)) continue;
    const topomap::LocalMap& earlier = maps[loop->earlier_id];
    const topomap::LocalMap& later = maps[loop->later_id];
    off_reference.push_back({*loop, offset.distance_m, offset.angle_rad,
                             in_common(earlier, later, loop->T_earlier_later),
                             in_common(earlier, later, *T)});
  }
  return off_reference;
}

std::vector<LoopOutcomeCounts> count_outcomes(const ReferencePoses& poses,
                                              std::span<const LoopCandidate> candidates) {
  std::map<std::pair<std::string, std::string>, LoopOutcomeCounts> counts;
  for (const LoopCandidate& candidate : candidates) {
    const std::optional<Pose2> T = between_stops(poses, pair_of(candidate));
    if (!T) continue;
    const LoopOffset offset = offset_of(candidate, *T);
    LoopOutcomeCounts& of = counts[{candidate.source, outcome_text(candidate)}];
    const bool right = offset.within(kRightMatch_m, kRightMatch_rad);
    const bool near = !right && offset.within(kNearMatch_m, kNearMatch_rad);
    ++(right ? of.right : near ? of.near : of.wrong);
  }
  std::vector<LoopOutcomeCounts> list;
  list.reserve(counts.size());
  for (auto& [key, of] : counts) {
    list.push_back({key.first, key.second, of.right, of.near, of.wrong});
  }
  return list;
}

Reliability reliability_of(const ReferencePoses& poses, std::span<const LoopCandidate> candidates) {
  const std::string unmatched = localization::to_string(localization::Reason::kNothingInCommon);
  Reliability reliability;
  for (const LoopCandidate& candidate : candidates) {
    const std::optional<Pose2> T = between_stops(poses, pair_of(candidate));
    if (!T || candidate.reason == unmatched) continue;
    reliability.add(candidate.probability,
                    offset_of(candidate, *T).within(kProbable_m, kProbable_rad));
  }
  return reliability;
}

/// Whether half of the points of the later stop are in view of the older one, on its surfaces.
bool in_view(const topomap::LocalMap& earlier, const topomap::LocalMap& later,
             const Pose2& T_earlier_later) {
  if (later.points.empty()) return false;
  const localization::Reference older =
      localization::make_reference(localization::extract_features(earlier));
  const auto there = [&](const topomap::ScanPoint& point) {
    const Eigen::Vector2d p = T_earlier_later * Eigen::Vector2d(point.x_m, point.y_m);
    const auto view = older.features->profile.view(p, kSeenThere_m);
    if (view != localization::RangeProfile::View::kFree &&
        view != localization::RangeProfile::View::kSurface) {
      return false;
    }
    const std::int32_t found = older.surface_grid.find(p.x(), p.y());
    if (found == localization::NearestPointGrid::kNone) return false;
    const localization::SurfacePoint& nearest =
        older.features->surface[static_cast<std::size_t>(found)];
    const Eigen::Vector2d off_m = p - nearest.position_m;
    return off_m.norm() <= kSame_m || (nearest.on_line && off_m.norm() <= kOutline_m &&
                                       std::fabs(off_m.dot(nearest.normal)) <= kSame_m);
  };
  const auto seen = std::ranges::count_if(later.points, there);
  return static_cast<double>(seen) >= kLeastInView * static_cast<double>(later.points.size());
}

std::vector<Revisit> find_revisits(std::span<const topomap::LocalMap> maps,
                                   const ReferencePoses& poses, const std::set<StopPair>& tried,
                                   const std::set<StopPair>& accepted) {
  std::vector<Revisit> revisits;
  const auto count = static_cast<std::uint32_t>(poses.size());
  for (std::uint32_t later = kRevisitStops; later < count; ++later) {
    Revisit revisit{later};
    bool near = false;
    for (std::uint32_t earlier = 0; earlier + kRevisitStops <= later; ++earlier) {
      const std::optional<Pose2> T = between_stops(poses, {earlier, later});
      if (!T || T->position_m().norm() >= kRevisit_m || std::fabs(T->theta_rad) >= kRevisit_rad) {
        continue;
      }
      near = true;
      revisit.tried |= tried.contains({earlier, later});
      revisit.accepted |= accepted.contains({earlier, later});
      if (!revisit.in_view) revisit.in_view = in_view(maps[earlier], maps[later], *T);
    }
    if (near) revisits.push_back(revisit);
  }
  return revisits;
}

void check_stops(std::span<const LoopCandidate> candidates, std::size_t stops) {
  for (const LoopCandidate& candidate : candidates) {
    if (candidate.earlier_id < candidate.later_id && candidate.later_id < stops) continue;
    throw std::invalid_argument(
        fmt::format("a loop candidate is of stops {} and {}, expected an earlier and a later one "
                    "of the {} stops of the map",
                    candidate.earlier_id, candidate.later_id, stops));
  }
}

}  // namespace

LoopRecall loop_recall(std::span<const topomap::LocalMap> maps,
                       std::span<const topomap::StampedPose> T_reference_robot,
                       std::span<const LoopCandidate> candidates, std::int64_t max_apart_ns) {
  check_stops(candidates, maps.size());
  const ReferencePoses poses = reference_poses(maps, T_reference_robot, max_apart_ns);
  LoopRecall recall;
  recall.stops = static_cast<std::size_t>(
      std::ranges::count_if(poses, [](const auto& pose) { return pose.has_value(); }));
  if (recall.stops == 0) {
    throw std::invalid_argument(
        fmt::format("none of the {} stops of the map has a reference pose within {:g} s",
                    maps.size(), seconds(max_apart_ns)));
  }
  const std::vector<const LoopCandidate*> loops = loops_of(candidates);
  std::set<StopPair> tried;
  std::set<StopPair> accepted;
  for (const LoopCandidate& candidate : candidates) tried.insert(pair_of(candidate));
  for (const LoopCandidate* loop : loops) accepted.insert(pair_of(*loop));
  recall.revisits = find_revisits(maps, poses, tried, accepted);
  recall.off_reference = loops_off_reference(maps, poses, loops);
  recall.outcomes = count_outcomes(poses, candidates);
  recall.reliability = reliability_of(poses, candidates);
  return recall;
}

std::size_t LoopRecall::tried() const {
  return static_cast<std::size_t>(std::ranges::count_if(revisits, &Revisit::tried));
}

std::size_t LoopRecall::accepted() const {
  return static_cast<std::size_t>(std::ranges::count_if(revisits, &Revisit::accepted));
}

std::size_t LoopRecall::in_view() const {
  return static_cast<std::size_t>(std::ranges::count_if(revisits, &Revisit::in_view));
}

std::size_t LoopRecall::accepted_in_view() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      revisits, [](const Revisit& revisit) { return revisit.in_view && revisit.accepted; }));
}

std::size_t LoopRecall::wrong() const {
  return static_cast<std::size_t>(std::ranges::count_if(off_reference, &LoopOffReference::wrong));
}

std::map<std::string, std::size_t> LoopRecall::rejected() const {
  std::map<std::string, std::size_t> counts;
  for (const LoopOutcomeCounts& of : outcomes) {
    if (of.right == 0 || of.outcome == localization::to_string(LoopOutcome::kAccepted)) continue;
    counts[of.outcome] += of.right;
  }
  return counts;
}

}  // namespace topogeo::pipeline
