#include "loop_figures.hpp"

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/storage/relations.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;
using topomap::LocalMap;
using topomap::StampedPose;

// The reference pose of a stop is that of its own scan.
constexpr std::int64_t kReferenceApart_ns = 1'000'000;

std::vector<LocalMap> local_maps_of(const Recording& recording, const pipeline::Config& config) {
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  std::vector<LocalMap> maps;
  for (const scan::Scan& scan : recording.scans) {
    if (auto map = mapper.add(scan)) maps.push_back(std::move(*map));
  }
  if (auto map = mapper.finish()) maps.push_back(std::move(*map));
  return maps;
}

void map_drive(localization::PoseGraphSlam& slam, const std::vector<LocalMap>& maps) {
  for (const LocalMap& map : maps) slam.add(std::make_shared<const LocalMap>(map));
  slam.finish();
}

std::vector<StampedPose> reference_of(const Recording& recording) {
  std::vector<StampedPose> reference;
  for (std::size_t i = 0; i < recording.scans.size(); ++i) {
    const scan::Scan& scan = recording.scans[i];
    if (!recording.T_world_robot[i]) continue;
    reference.push_back({scan.sequence, scan.stamp_ns, *recording.T_world_robot[i]});
  }
  return reference;
}

/// Reference poses by local map id.
std::vector<std::optional<Pose2>> reference_of_stops(const std::vector<LocalMap>& maps,
                                                     const std::vector<StampedPose>& reference) {
  std::map<std::int64_t, Pose2> pose_at;
  for (const StampedPose& pose : reference) pose_at.emplace(pose.stamp_ns, pose.pose);
  std::vector<std::optional<Pose2>> poses(maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const auto found = pose_at.find(maps[i].stamp_ns);
    if (found != pose_at.end()) poses[i] = found->second;
  }
  return poses;
}

std::vector<storage::LoopCandidate> candidates_of(const localization::PoseGraphSlam& slam) {
  storage::Report report;
  results::add_loop_candidates(report, slam.loop_decisions());
  return std::move(report.loop_candidates);
}

}  // namespace

LoopFigures measure_loops(const Recording& recording, const pipeline::Config& config,
                          const std::optional<std::filesystem::path>& relations) {
  support::StageTimes times;
  std::vector<LocalMap> maps;
  localization::InProcessPool pool;
  localization::PoseGraphSlam slam(config.localizer, pool);
  {
    const auto scope = times.measure("mapping");
    maps = local_maps_of(recording, config);
    map_drive(slam, maps);
  }
  const std::vector<StampedPose> reference = reference_of(recording);
  const std::vector<StampedPose> corrected = topomap::expand_trajectory(slam.trajectory(), maps);

  LoopFigures figures;
  figures.name = recording.name;
  figures.stops = maps.size();
  figures.error = pipeline::trajectory_error(corrected, reference);
  if (relations) {
    figures.relations = pipeline::relations_error(corrected, storage::read_relations(*relations));
  }
  figures.recall = pipeline::loop_recall(maps, reference, candidates_of(slam), kReferenceApart_ns);
  figures.triangles = match_triangles(slam.graph());
  const std::vector<std::optional<Pose2>> T_world_stop = reference_of_stops(maps, reference);
  figures.predictions = revisit_predictions(slam.loop_decisions(), T_world_stop);
  figures.decisions = judged_decisions(slam.loop_decisions(), T_world_stop);
  figures.match_tasks = slam.counts().tasks;
  figures.cpu_s = times.stages().front().cpu_s;
  return figures;
}

}  // namespace topogeo::bench
