// The map store that shows an existing map, and the command that lists its places.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/stream.h"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/world/world.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two rooms of 4 x 4 m with a door between them, seen from the door, and a name for each.
storage::MapDocument two_rooms() {
  storage::MapDocument document;
  document.robot_id = "robot";
  topomap::LocalMap& map = document.local_maps.emplace_back();
  map.robot_id = "robot";
  map.stamp_ns = 5'000'000'000;
  const auto add = [&](double x_m, double y_m) {
    map.points.push_back({static_cast<float>(x_m - 4.0), static_cast<float>(y_m - 2.0)});
  };
  for (int k = 0; k <= 160; ++k) {
    const double along_m = 0.05 * k;
    add(along_m, 0.0);
    add(along_m, 4.0);
    if (along_m > 4.0) continue;
    add(0.0, along_m);
    add(8.0, along_m);
    if (along_m < 1.5 || along_m > 2.5) add(4.0, along_m);
  }
  document.trajectory.stops.push_back(
      {0, map.stamp_ns, {4.0, 2.0, 0.0}, Eigen::Matrix3d::Identity()});
  document.global_map.version = 3;
  document.global_map.nodes = {{1, topomap::NodeKind::kReal, {2.0, 2.0}, 2.0, 3},
                               {2, topomap::NodeKind::kDoor, {4.0, 2.0}, 0.5, 3},
                               {3, topomap::NodeKind::kReal, {6.0, 2.0}, 2.0, 3}};
  document.global_map.branches = {{1, 1, 2, false, 3, {{{2.0, 2.0}, 2.0}, {{4.0, 2.0}, 0.5}}},
                                  {2, 2, 3, false, 3, {{{4.0, 2.0}, 0.5}, {{6.0, 2.0}, 2.0}}}};
  document.drawing.places = {{"room A", {2.0, 2.0}}, {"room B", {6.0, 2.0}}};
  return document;
}

constexpr const char* kWorld =
    "walls:\n"
    "  - {from: [0, 0], to: [6, 0]}\n"
    "  - {from: [6, 0], to: [6, 4]}\n"
    "  - {from: [6, 4], to: [0, 4]}\n"
    "  - {from: [0, 4], to: [0, 0]}\n"
    "tour: [[1, 1]]\n"
    "places: [{name: desk, at: [5, 3]}]\n";

/// State of a program that starts now and reads the maps.
struct LateReader {
  LateReader(const std::string& domain, const std::string& partition)
      : participant([&] {
          messaging::ParticipantOptions options;
          options.domain = static_cast<std::uint32_t>(std::stoul(domain));
          options.partition = partition;
          options.name = "late reader";
          return options;
        }()) {
    loop.add<msg::MapElement>(elements, [this](const auto& element, const auto& info) {
      follower.put(element, info.instance.bytes, info.writer.bytes);
    });
  }

  bool wait() {
    return wait_in_loop(loop, "both maps", [&] { return hybrid.map() && follower.map(); });
  }

  messaging::Participant participant;
  messaging::EventLoop loop;
  messaging::Reader<msg::MapElement> elements{participant};
  map_client::MapFollower follower{"robot"};
  service::LiveHybridMap hybrid{participant, loop,
                                [](const auto& message, const auto& use) { use(message); }};
};

void expect_same(const planning::HybridMap& got, const planning::HybridMap& expected) {
  EXPECT_EQ(got.frame().T_map_grid, expected.frame().T_map_grid);
  EXPECT_TRUE(std::ranges::equal(got.space().grid().cells(), expected.space().grid().cells()));
  EXPECT_EQ(got.zones().zone_of_cell, expected.zones().zone_of_cell);
  ASSERT_EQ(got.nodes().size(), expected.nodes().size());
  for (std::size_t i = 0; i < got.nodes().size(); ++i) {
    EXPECT_EQ(got.nodes()[i].position_m, expected.nodes()[i].position_m);
  }
  ASSERT_EQ(got.places().size(), expected.places().size());
  for (std::size_t i = 0; i < got.places().size(); ++i) {
    EXPECT_EQ(got.places()[i].name, expected.places()[i].name);
    EXPECT_EQ(got.places()[i].position_m, expected.places()[i].position_m);
  }
}

class MapStoreShows : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(scratch_ / name) << text;
    return scratch_ / name;
  }
  std::filesystem::path write_map() {
    storage::write_map_file(scratch_ / "map.pb", two_rooms());
    return scratch_ / "map.pb";
  }
  std::vector<std::string> in_domain(std::vector<std::string> words) const {
    words.insert(words.end(), {"--domain", own_domain(), "--partition", partition_});
    return words;
  }
  /// Exit code of `topogeo places` with these words; its output is in out_ and err_.
  int places(std::vector<std::string> words) {
    words.insert(words.begin(), "places");
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    out_ = program.out();
    err_ = program.err();
    return code;
  }

  // A killed program leaves segments in /dev/shm that others may still wait at.
  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = "maps" + std::to_string(std::random_device{}());
  Scratch scratch_;
  std::string out_;
  std::string err_;
};

TEST_F(MapStoreShows, AStoredMapToWhoeverComesLate) {
  Program store(scratch_, "map_store", in_domain({"--map", write_map().string()}));
  store.wait_for_error_text("serves a map of 1 local maps, 2 zones and 2 places");
  LateReader reader(own_domain(), partition_);
  ASSERT_TRUE(reader.wait());
  const storage::MapDocument document = two_rooms();
  expect_same(*reader.hybrid.map(), pipeline::make_hybrid_map(pipeline::parts_of(document), {}));
  const topomap::GlobalMap global = service::from_elements(*reader.follower.map());
  EXPECT_EQ(global.version, 3U);
  ASSERT_EQ(global.nodes.size(), 3U);
  EXPECT_EQ(global.nodes[1].kind, topomap::NodeKind::kDoor);
  EXPECT_EQ(global.nodes[2].position_m, document.global_map.nodes[2].position_m);
  ASSERT_EQ(global.branches.size(), 2U);
  EXPECT_EQ(global.branches[1].node_b, 3U);

  EXPECT_EQ(places(in_domain({"--wait-seconds", "600"})), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("room B"));
  EXPECT_THAT(out_, HasSubstr("6.00     2.00  zone 1"));
  store.send_signal(SIGTERM);
  EXPECT_EQ(store.wait(), 0);
}

TEST_F(MapStoreShows, ADrawingOverAMap) {
  const auto world = write("yard.world.yaml", kWorld);
  Program store(scratch_, "map_store",
                in_domain({"--map", write_map().string(), "--drawing", world.string(),
                           "--drawing-pose", "-9,1,90"}));
  store.wait_for_error_text("serves a map");
  LateReader reader(own_domain(), partition_);
  ASSERT_TRUE(reader.wait());
  storage::MapDocument document = two_rooms();
  pipeline::lay_over(document.drawing,
                     pipeline::read_drawing(world, {}, 0.1, {-9.0, 1.0, 1.5707963267948966}));
  expect_same(*reader.hybrid.map(), pipeline::make_hybrid_map(pipeline::parts_of(document), {}));
  EXPECT_EQ(reader.hybrid.map()->places().size(), 3U);
}

// Results of a drive, sent like local mapper and localizer do.
TEST_F(MapStoreShows, TheMapOfADriveWithItsPlaces) {
  pipeline::MappingRun run({}, "robot");
  const world::World world =
      world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml");
  for (const scan::Scan& scan : simulation::simulate_log(world, {}).scans) run.add(scan);
  storage::MapDocument expected = run.finish();
  const auto names = write("names.yaml", "places: [{name: start, at: [0, 0]}]\n");
  expected.drawing = pipeline::read_zones_and_places(names);

  Program store(scratch_, "map_store",
                in_domain({"--out", (scratch_ / "out").string(), "--places", names.string()}));
  LateReader reader(own_domain(), partition_);
  messaging::Writer<msg::LocalMap> maps(reader.participant);
  messaging::Writer<msg::TrajectorySegment> segments(reader.participant);
  messaging::Writer<msg::LoopClosures> closures(reader.participant);
  messaging::Writer<msg::MapEdges> edges(reader.participant);
  messaging::Writer<msg::StreamEnd> ends(reader.participant);
  for (const topomap::LocalMap& map : expected.local_maps) {
    ASSERT_TRUE(maps.write(service::to_msg(map)));
  }
  for (const auto& segment : service::to_segments(expected.trajectory, "robot", 0)) {
    ASSERT_TRUE(segments.write(segment));
  }
  ASSERT_TRUE(closures.write(
      service::to_msg(expected.loop_closures, expected.trajectory.version, "robot", 0, 0)));
  for (std::uint32_t i = 0; i < service::edge_segment_count(expected.edges.size()); ++i) {
    ASSERT_TRUE(edges.write(
        service::to_segment(expected.edges, i, expected.trajectory.version, "robot", 0, i)));
  }
  ASSERT_TRUE(reader.wait()) << "there is a map while the drive lasts";

  msg::StreamEnd end;
  messaging::set_header(end, "robot", expected.local_maps.back().stamp_ns, 0);
  end.stage(msg::kStageLocalizer);
  end.count(expected.trajectory.stops.size());
  end.version(expected.trajectory.version);
  ASSERT_TRUE(ends.write(end));
  store.wait_for_error_text("local maps, ");  // the final line
  const planning::HybridMap hybrid = pipeline::make_hybrid_map(pipeline::parts_of(expected), {});
  const auto is_final = [&] {
    const auto map = reader.hybrid.map();
    return map && map->nodes().size() == hybrid.nodes().size() &&
           map->zones().zone_of_cell == hybrid.zones().zone_of_cell;
  };
  EXPECT_TRUE(wait_in_loop(reader.loop, "the map of the whole drive", is_final));
  expect_same(*reader.hybrid.map(), hybrid);
  expected.rooms = {};  // they come with the drawing
  pipeline::remember_rooms(expected, {});
  EXPECT_TRUE(storage::map_file_bytes(expected) == read_file(scratch_ / "out" / "map.pb"));
}

TEST_F(MapStoreShows, NothingOfWhatIsNoMap) {
  const auto expect = [&](const std::vector<std::string>& words, int code, const char* message) {
    Program store(scratch_, "map_store", words);
    EXPECT_EQ(store.wait(), code);
    EXPECT_THAT(store.err(), HasSubstr(message));
  };
  expect({"--map", write("no.pb", "nonsense").string()}, 3, "no.pb: not a topogeo map");
  storage::MapDocument blind = two_rooms();
  blind.local_maps[0].points.clear();
  storage::write_map_file(scratch_ / "blind.pb", blind);
  expect({"--map", (scratch_ / "blind.pb").string()}, 3, "no stop with scan points");
  expect({"--map", write_map().string(), "--out", (scratch_ / "out").string()}, 2,
         "expected no --out, --new or --continue");
  expect({"--drawing", write("bad.world.yaml", "walls: 3").string()}, 3, "bad.world.yaml:1: walls");
  expect({"--map", write_map().string(), "--drawing-pose", "1,2,3"}, 2, "need --drawing");
  expect({"--drawing", write("a.world.yaml", kWorld).string(), "--drawing-pose", "1,2"}, 2,
         "--drawing-pose: ");
  expect({}, 2, "--out is required");
}

TEST_F(MapStoreShows, PlacesOfAFileCanBeChanged) {
  const std::string map = write_map().string();
  EXPECT_EQ(
      places({map, "--add", "kitchen=6.5,3", "--add", "room A=1.5,1.5", "--remove", "room B"}), 0)
      << err_;
  EXPECT_THAT(out_, HasSubstr("kitchen"));
  EXPECT_THAT(out_, Not(HasSubstr("room B")));
  const storage::MapDocument read = storage::read_map_file(map);
  ASSERT_EQ(read.drawing.places.size(), 2U);
  EXPECT_EQ(read.drawing.places[0].position_m, Eigen::Vector2d(1.5, 1.5));
  EXPECT_EQ(read.drawing.places[1].name, "kitchen");
  EXPECT_EQ(read.local_maps.size(), 1U) << "the rest of the map is as it was";

  const std::string before = read_file(map);
  const auto refused = [&](const std::vector<std::string>& words, int code, const char* message) {
    std::vector<std::string> all{map};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(places(all), code);
    EXPECT_THAT(err_, HasSubstr(message));
    EXPECT_EQ(read_file(map), before);
  };
  refused({"--remove", "room B"}, 3, "there is no such place, the map has 'room A', 'kitchen'");
  refused({"--add", "a=1"}, 2, "expected NAME=X,Y");
  refused({"--add", "=1,2"}, 2, "expected a name of 1 to 64 bytes");
  refused({"--add", "1,2=3,4"}, 2, "would be taken for a point");
  refused({"--add", "far=1e9,0"}, 2, "coordinate 1000000000");
  refused({"--add", "garden=100,100"}, 2, "--add 'garden': 100,100 is outside of the map");
}

TEST_F(MapStoreShows, ABaseStationHasItsHeadingInDegrees) {
  const std::string map = write_map().string();
  ASSERT_EQ(places({map, "--add", "base station=1.5,-2,90", "--add", "dock=0,0,-450"}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("base station             1.50    -2.00"));
  EXPECT_THAT(out_, HasSubstr(", base station, heading 90.0 deg"));
  const auto place = [&](const std::string& name) {
    const auto all = storage::read_map_file(map).drawing.places;
    const auto found = std::ranges::find(all, name, &planning::Place::name);
    return found == all.end() ? planning::Place{} : *found;
  };
  ASSERT_TRUE(place("base station").station_heading_rad);
  EXPECT_NEAR(*place("base station").station_heading_rad, std::numbers::pi / 2.0, 1e-12);
  EXPECT_EQ(place("base station").position_m, Eigen::Vector2d(1.5, -2.0));
  ASSERT_TRUE(place("dock").station_heading_rad);
  EXPECT_NEAR(std::cos(*place("dock").station_heading_rad), 0.0, 1e-12) << "once round and back";
  EXPECT_NEAR(std::sin(*place("dock").station_heading_rad), -1.0, 1e-12);

  // Added again without a heading, it is an ordinary place.
  ASSERT_EQ(places({map, "--add", "base station=1,1"}), 0) << err_;
  EXPECT_FALSE(place("base station").station_heading_rad);
  const std::string before = read_file(map);
  for (const char* text : {"a=1,2,", "a=1,2,north", "a=1,2,nan", "a=1,2,3,4"}) {
    EXPECT_EQ(places({map, "--add", text}), 2) << text;
    EXPECT_THAT(err_, HasSubstr("NAME=X,Y,DEG")) << text;
  }
  EXPECT_EQ(read_file(map), before);
}

TEST_F(MapStoreShows, PlacesOfAWorldAreListed) {
  const auto world = write("yard.world.yaml", kWorld);
  EXPECT_EQ(places({world.string()}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("desk                     5.00     3.00  zone 0"));
  EXPECT_THAT(out_, HasSubstr("zone   0"));
  EXPECT_EQ(places({world.string(), "--add", "a=1,1"}), 2);
  EXPECT_EQ(places({(scratch_ / "none.pb").string()}), 3);
  EXPECT_THAT(err_, HasSubstr("none.pb: cannot be opened"));
  EXPECT_EQ(places(in_domain({"live", "--wait-seconds", "0.2"})), 1);
  EXPECT_THAT(err_, HasSubstr("no hybrid map of robot 'robot'"));
}

}  // namespace
}  // namespace topogeo::test
