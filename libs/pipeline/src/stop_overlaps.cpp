#include "topogeo/pipeline/stop_overlaps.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "topogeo/session/slam_session.hpp"
#include "topogeo/topomap/visible_rectangle.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using topomap::VisibleRectangle;
using MatchedPair = std::pair<std::uint32_t, std::uint32_t>;  // later, earlier

std::set<MatchedPair> matched_pairs(const storage::MapDocument& map) {
  std::set<MatchedPair> pairs;
  const auto add = [&](std::uint32_t a, std::uint32_t b) { pairs.insert(std::minmax(a, b)); };
  for (const storage::MapEdge& edge : map.edges) {
    if (edge.kind == storage::MapEdge::Kind::kSequential ||
        edge.kind == storage::MapEdge::Kind::kLoop) {
      add(edge.earlier_id, edge.later_id);
    }
  }
  for (const topomap::LoopClosure& loop : map.loop_closures) add(loop.earlier_id, loop.later_id);
  std::set<MatchedPair> by_later;
  for (const auto& [earlier, later] : pairs) by_later.emplace(later, earlier);
  return by_later;
}

}  // namespace

std::vector<StopOverlaps> stop_overlaps(const storage::MapDocument& map,
                                        const localization::LocalizerConfig& config) {
  const std::vector<topomap::StopPose>& poses = map.trajectory.stops;
  const std::size_t stops = std::min(map.local_maps.size(), poses.size());
  const std::set<MatchedPair> matched = matched_pairs(map);
  std::vector<VisibleRectangle> views;
  std::vector<StopOverlaps> found;
  for (std::uint32_t i = 0; i < stops; ++i) {
    const VisibleRectangle view = topomap::visible_rectangle(
        map.local_maps[i], config.evidence == localization::MatchEvidence::kScan);
    if (i > 0 && poses[i].located) {
      StopOverlaps& of_stop = found.emplace_back();
      of_stop.stop = i;
      for (std::uint32_t k = 0; k < i; ++k) {
        const Pose2 T_earlier_stop = geometry::between(poses[k].T_map_robot, poses[i].T_map_robot);
        if (poses[k].located &&
            overlap(seen_from(view, T_earlier_stop, Eigen::Vector3d::Zero()), views[k])) {
          of_stop.overlap_set.push_back(k);
        }
      }
      for (auto pair = matched.lower_bound({i, 0}); pair != matched.end() && pair->first == i;
           ++pair) {
        const std::uint32_t k = pair->second;
        if (!poses[k].located) continue;
        const localization::UncertainPose predicted{
            geometry::between(poses[k].T_map_robot, poses[i].T_map_robot),
            localization::given_pose_covariance()};
        of_stop.searches.push_back(
            {k, search_stop(map.local_maps[k], map.local_maps[i], predicted, config)});
      }
    }
    views.push_back(view);
  }
  return found;
}

}  // namespace topogeo::pipeline
