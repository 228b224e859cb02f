#include "topogeo/storage/map_file.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

using MapFile = ScratchDirectory;

TEST_F(MapFile, GivesBackEveryField) {
  write_map_file(directory_ / "map.pb", sample_document(3));
  const MapDocument read = read_map_file(directory_ / "map.pb");

  EXPECT_EQ(read.robot_id, "robot-1");
  EXPECT_EQ(read.seed, 0xfedcba9876543210ULL);
  ASSERT_EQ(read.local_maps.size(), 3U);
  const topomap::LocalMap& map = read.local_maps[2];
  EXPECT_EQ(map.id, 2U);
  EXPECT_EQ(map.sequence, 20U);
  EXPECT_EQ(map.stamp_ns, 2'000'000'007);
  EXPECT_EQ(map.T_odom_robot, (geometry::Pose2{2.0, -1.0, 0.1}));
  EXPECT_EQ(map.T_previous_robot, (geometry::Pose2{1.0, 0.25, -0.2}));
  EXPECT_TRUE(std::signbit(map.T_robot_laser.y_m));
  ASSERT_EQ(map.nodes.size(), 2U);
  EXPECT_EQ(map.nodes[0].base_groups, (std::vector<std::uint16_t>{0, 3, 65535}));
  EXPECT_TRUE(map.nodes[0].in_main_graph);
  EXPECT_EQ(map.nodes[1].id, 1U);
  EXPECT_EQ(map.nodes[1].kind, topomap::NodeKind::kHallCorridor);
  EXPECT_EQ(map.nodes[1].position_m, Eigen::Vector2d(3.0, 1.0 / 3.0));
  EXPECT_EQ(map.nodes[1].clearance_m, 1.1);
  ASSERT_EQ(map.branches.size(), 1U);
  EXPECT_EQ(map.branches[0].node_b, 1U);
  EXPECT_EQ(map.branches[0].base_groups, (std::array<std::uint16_t, 2>{2, 5}));
  EXPECT_TRUE(map.branches[0].is_virtual);
  EXPECT_FALSE(map.branches[0].in_main_graph);
  EXPECT_FALSE(map.branches[0].confirmed);
  ASSERT_EQ(map.branches[0].points.size(), 2U);
  EXPECT_EQ(map.branches[0].points[1].position_m, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(map.branches[0].points[1].clearance_m, 1.1);
  ASSERT_EQ(map.points.size(), 3U);
  EXPECT_EQ(map.points[1].x_m, -2.25F);
  ASSERT_EQ(map.track.size(), 1U);
  EXPECT_EQ(map.track[0].sequence, 19U);
  EXPECT_EQ(map.track[0].T_stop_robot, (geometry::Pose2{0.4, 0.5, 0.6}));
  EXPECT_TRUE(map.track[0].matched);

  EXPECT_EQ(read.trajectory.version, 9U);
  ASSERT_EQ(read.trajectory.stops.size(), 3U);
  EXPECT_EQ(read.trajectory.stops[2].T_map_robot, (geometry::Pose2{1.0, 2.0, -3.0}));
  EXPECT_EQ(read.trajectory.stops[2].covariance(1, 2), 6.0);
  ASSERT_EQ(read.loop_closures.size(), 2U);
  EXPECT_EQ(read.loop_closures[1].later_id, 2U);
  EXPECT_EQ(read.loop_closures[1].T_earlier_later.theta_rad, 3.0);
  ASSERT_EQ(read.global_map.nodes.size(), 2U);
  EXPECT_EQ(read.global_map.nodes[0].kind, topomap::NodeKind::kDoor);
  EXPECT_EQ(read.global_map.nodes[0].observations, 3U);
  ASSERT_EQ(read.global_map.branches.size(), 1U);
  EXPECT_EQ(read.global_map.branches[0].node_b, 7U);
}

TEST_F(MapFile, IsTheSameBytesWhenReadAndWrittenAgain) {
  for (const std::uint32_t count : {0U, 1U, 3U}) {
    const std::string bytes = map_file_bytes(sample_document(count));
    EXPECT_EQ(map_file_bytes(parse_map_file(bytes, "map.pb")), bytes) << count;
  }
  const std::string empty = map_file_bytes(MapDocument{});
  EXPECT_EQ(map_file_bytes(parse_map_file(empty, "map.pb")), empty);
}

TEST_F(MapFile, RefusesEveryTruncation) {
  const std::string bytes = map_file_bytes(sample_document(1));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_NE(error_of([&] { parse_map_file(bytes.substr(0, size), "map.pb"); }), "") << size;
  }
  EXPECT_THAT(error_of([&] { parse_map_file(bytes.substr(0, bytes.size() - 40), "map.pb"); }),
              StartsWith("map.pb: cut short or damaged"));
}

TEST_F(MapFile, RefusesEveryChangedByte) {
  const std::string bytes = map_file_bytes(sample_document(1));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    ASSERT_NE(error_of([&] { parse_map_file(changed, "map.pb"); }), "") << i;
  }
}

TEST_F(MapFile, SaysWhatAnotherFileIs) {
  EXPECT_THAT(error_of([&] { parse_map_file("", "a"); }), HasSubstr("a: empty"));
  EXPECT_THAT(error_of([&] {
                parse_map_file(
                    "\x7f"
                    "ELF\x02\x01",
                    "a");
              }),
              HasSubstr("a: not a topogeo map"));
  std::string newer = map_file_bytes(sample_document(1));
  newer[14] = 2;  // after field 1 (13 bytes) and the tag of field 2
  EXPECT_THAT(error_of([&] { parse_map_file(newer, "a"); }),
              HasSubstr("a: map format version 2, this program reads up to 1"));
  EXPECT_THAT(error_of([&] { read_map_file(directory_ / "missing.pb"); }),
              HasSubstr("missing.pb: cannot be opened: No such file"));
  EXPECT_THAT(error_of([&] { read_map_file(directory_); }), HasSubstr("is a directory"));
  EXPECT_THAT(error_of([&] { write_map_file("/proc/map.pb", sample_document(1)); }),
              HasSubstr("/proc/map.pb: cannot be created"));
}

TEST_F(MapFile, RefusesToWriteAMapThatContradictsItself) {
  const auto refused = [](auto change) {
    MapDocument document = sample_document(3);
    change(document);
    EXPECT_THROW(map_file_bytes(document), std::invalid_argument);
  };
  refused([](MapDocument& d) { d.local_maps[1].id = 5; });
  refused([](MapDocument& d) { d.local_maps[1].robot_id = ""; });
  refused([](MapDocument& d) { d.local_maps.pop_back(); });
  refused([](MapDocument& d) { d.trajectory.stops[0].local_map_id = 1; });
  refused([](MapDocument& d) { d.loop_closures[0].later_id = 3; });
  refused([](MapDocument& d) { d.loop_closures[0].earlier_id = 2; });
  refused([](MapDocument& d) { d.global_map.nodes[0].id = 7; });
  refused([](MapDocument& d) { d.global_map.branches[0].node_a = 3; });
}

TEST_F(MapFile, RefusesAContentThatCannotBeUsed) {
  const auto refusal = [](auto change) {
    MapDocument document = sample_document(1);
    change(document);
    const std::string bytes = map_file_bytes(document);
    return error_of([&] { parse_map_file(bytes, "map.pb"); });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([](MapDocument& d) { d.local_maps[0].branches[0].node_b = 2; }),
              HasSubstr("branch 0 from node 0 to node 2: expected less than 2"));
  EXPECT_THAT(refusal([](MapDocument& d) { d.local_maps[0].branches[0].points.pop_back(); }),
              HasSubstr("expected at least two"));
  EXPECT_THAT(refusal([](MapDocument& d) { d.local_maps[0].points[0].x_m = float(kNan); }),
              HasSubstr("scan point 0 is not finite"));
  EXPECT_THAT(refusal([](MapDocument& d) { d.trajectory.stops[0].covariance(0, 0) = kNan; }),
              HasSubstr("covariance of a stop is not a finite number"));
  EXPECT_THAT(refusal([](MapDocument& d) {
                d.global_map.nodes[0].kind = static_cast<topomap::NodeKind>(6);
              }),
              HasSubstr("node kind 6: expected 0 to 5"));
}

}  // namespace
}  // namespace topogeo::storage
