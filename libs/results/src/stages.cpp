#include "topogeo/results/stages.hpp"

#include <memory>
#include <utility>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/render/map_picture.hpp"
#include "topogeo/session/slam_session.hpp"

namespace topogeo::results {
namespace {

constexpr const char* kOdometryStage = "1_odometry";

topomap::Trajectory by_odometry(const std::vector<topomap::LocalMap>& maps) {
  topomap::Trajectory trajectory;
  for (const topomap::LocalMap& map : maps) {
    trajectory.stops.push_back({map.id, map.stamp_ns,
                                geometry::between(maps.front().T_odom_robot, map.T_odom_robot),
                                Eigen::Matrix3d::Zero()});
  }
  return trajectory;
}

CorrectionStage localized(std::string name, std::string title,
                          const localization::LocalizerConfig& config,
                          const std::vector<topomap::LocalMap>& maps) {
  localization::InProcessPool pool;
  const std::unique_ptr<localization::Slam> slam = localization::make_slam(config, pool);
  for (const topomap::LocalMap& map : maps) {
    slam->add(std::make_shared<const topomap::LocalMap>(map));
  }
  slam->finish();
  return {std::move(name), std::move(title), slam->trajectory(), slam->loop_closures()};
}

}  // namespace

std::vector<CorrectionStage> correction_stages(const pipeline::Config& config,
                                               const storage::MapDocument& document) {
  localization::LocalizerConfig backward = config.localizer;
  backward.final_passes = 0;
  localization::LocalizerConfig forward = backward;
  forward.revisit_matches = 0;
  const std::vector<topomap::LocalMap>& maps = document.local_maps;
  std::vector<CorrectionStage> stages;
  stages.push_back({kOdometryStage, "odometry alone", by_odometry(maps), {}});
  stages.push_back(localized("2_forward", "forward correction, no cycle closed", forward, maps));
  stages.push_back(localized("3_backward", "cycles closed", backward, maps));
  stages.push_back({"4_final", "final map", document.trajectory, document.loop_closures});
  return stages;
}

void write_stage_pictures(const std::filesystem::path& directory, const pipeline::Config& config,
                          const storage::MapDocument& document, const std::string& title) {
  for (const CorrectionStage& stage : correction_stages(config, document)) {
    const bool uncorrected = stage.name == kOdometryStage;
    const auto poses = uncorrected
                           ? topomap::expand_odometry(document.local_maps)
                           : topomap::expand_trajectory(stage.trajectory, document.local_maps);
    const topomap::GlobalMap map =
        pipeline::fuse(config.global_map, document.local_maps, stage.trajectory);
    render::MapPicture picture;
    picture.local_maps = document.local_maps;
    picture.stops = stage.trajectory.stops;
    (uncorrected ? picture.odometry : picture.corrected) = poses;
    picture.loop_closures = stage.loop_closures;
    picture.global_map = &map;
    picture.title = title + ": " + stage.title;
    render::draw_map_png(directory / ("stage_" + stage.name + ".png"), picture);
  }
}

}  // namespace topogeo::results
