// Overlap sets and searches of a small map, against its geometry and topogeo match's own search.
#include "topogeo/pipeline/stop_overlaps.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/topomap/visible_rectangle.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {
namespace {

const Config& room_config() {
  static const Config config = load_config({}).config;
  return config;
}

const storage::MapDocument& room_document() {
  static const storage::MapDocument document = [] {
    MappingRun run(room_config(), "robot");
    const auto log = simulation::simulate_log(
        world::load_world(std::filesystem::path(TOPOGEO_SHARE) / "worlds/room.world.yaml"), {});
    for (const scan::Scan& scan : log.scans) run.add(scan);
    return run.finish();
  }();
  return document;
}

// Uses the function of the thesis's definition 7.3.3.
std::vector<std::uint32_t> overlap_set_of(const storage::MapDocument& map, std::uint32_t stop) {
  const auto& poses = map.trajectory.stops;
  std::vector<topomap::VisibleRectangle> views;
  std::vector<topomap::PlacedView> places;
  for (std::uint32_t k = 0; k < stop; ++k) {
    views.push_back(topomap::visible_rectangle(map.local_maps[k]));
    places.push_back({geometry::between(poses[k].T_map_robot, poses[stop].T_map_robot),
                      Eigen::Vector3d::Zero()});
  }
  return topomap::overlap_set(topomap::visible_rectangle(map.local_maps[stop]), views, places);
}

TEST(StopOverlapsTest, AreThoseOfTheFieldsOfViewAndTheMatchesOfTheMap) {
  const storage::MapDocument& map = room_document();
  const std::vector<StopOverlaps> found = stop_overlaps(map, room_config().localizer);
  ASSERT_EQ(found.size() + 1, map.trajectory.stops.size());
  std::size_t searches = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].stop, i + 1);
    EXPECT_EQ(found[i].overlap_set, overlap_set_of(map, found[i].stop));
    ASSERT_FALSE(found[i].overlap_set.empty());
    EXPECT_EQ(found[i].overlap_set.back(), i);  // the stop before
    for (const SearchedStop& searched : found[i].searches) {
      EXPECT_LT(searched.earlier, found[i].stop);
      ++searches;
    }
  }
  EXPECT_GE(searches, found.size());  // each stop was matched with the previous one
}

TEST(StopOverlapsTest, SearchesAreThoseOfTwoStops) {
  const storage::MapDocument& map = room_document();
  const std::vector<StopOverlaps> found = stop_overlaps(map, room_config().localizer);
  ASSERT_FALSE(found.back().searches.empty());
  const SearchedStop& searched = found.back().searches.back();
  const auto& stops = map.trajectory.stops;
  const StopSearch again = search_stop(
      map.local_maps[searched.earlier], map.local_maps[found.back().stop],
      {geometry::between(stops[searched.earlier].T_map_robot, stops[found.back().stop].T_map_robot),
       localization::given_pose_covariance()},
      room_config().localizer);
  EXPECT_EQ(searched.search.result.T_reference_query, again.result.T_reference_query);
  EXPECT_EQ(searched.search.result.fitness, again.result.fitness);
  EXPECT_EQ(searched.search.result.verdict, localization::Verdict::kAccepted);
}

TEST(StopOverlapsTest, StopsThatAreNotLocatedAreLeftOut) {
  storage::MapDocument map = room_document();
  map.trajectory.stops[2].located = false;
  for (const StopOverlaps& of_stop : stop_overlaps(map, room_config().localizer)) {
    EXPECT_NE(of_stop.stop, 2U);
    EXPECT_EQ(std::count(of_stop.overlap_set.begin(), of_stop.overlap_set.end(), 2U), 0);
    for (const SearchedStop& searched : of_stop.searches) EXPECT_NE(searched.earlier, 2U);
  }
  EXPECT_TRUE(stop_overlaps({}, room_config().localizer).empty());
}

}  // namespace
}  // namespace topogeo::pipeline
