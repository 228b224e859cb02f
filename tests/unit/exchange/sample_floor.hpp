// A hand-made map, and helpers for tests that write and read files.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// Two rooms joined by a door (a branch with a bend at (2, 0.4)) and by a passage of 0.2 m on each
/// side, a loop of two parallel branches, and a virtual branch. Numbers have many digits on
/// purpose.
inline topomap::GlobalMap sample_graph() {
  using topomap::NodeKind;
  topomap::GlobalMap map;
  map.version = 12;
  map.nodes = {{2, NodeKind::kReal, {0.0, 0.0}, 0.9, 3, 1'700'000'000'123'456'789},
               {7, NodeKind::kDoor, {4.0, 0.5}, 0.45, 11},
               {9, NodeKind::kHallCorridor, {8.0, 1.0 / 3.0}, 1.0, 1},
               {12, NodeKind::kFictitious, {8.0, 4.0}, 0.5, 2}};
  map.branches = {
      {1, 2, 7, false, 5, {{{0.0, 0.0}, 0.9}, {{2.0, 0.4}, 0.1 + 0.6}, {{4.0, 0.5}, 0.45}}, 5},
      {3, 7, 9, false, 4, {{{4.0, 0.5}, 0.45}, {{6.0, 1.5}, 0.8}, {{8.0, 1.0 / 3.0}, 1.0}}},
      {4, 7, 9, false, 2, {{{4.0, 0.5}, 0.45}, {{6.0, -1.5}, 0.8}, {{8.0, 1.0 / 3.0}, 1.0}}},
      {6,
       9,
       12,
       false,
       1,
       {{{8.0, 1.0 / 3.0}, 1.0},
        {{8.0, 2.0}, 0.5},
        {{8.0, 2.5}, 0.2},
        {{8.0, 3.0}, 0.5},
        {{8.0, 4.0}, 0.5}}},
      {8, 2, 12, true, 1, {{{0.0, 0.0}, 0.9}, {{8.0, 4.0}, 0.5}}}};
  return map;
}

inline storage::MapDrawing sample_drawing() {
  storage::MapDrawing drawing;
  drawing.places = {{"room <A> & \"B\"", {0.0, -0.6}}, {"Küche", {8.0, 1.0 / 3.0}, -2.0 / 3.0}};
  // The last two are on the two parallel branches; the hall's corners are clockwise.
  using planning::ZoneKind;
  drawing.zones = {
      {"stairs", {{1.0, 1.0}, {3.0, 1.0}, {3.0, 2.0 / 3.0 + 2.0}}, ZoneKind::kNoGo, 0.0},
      {"hall", {{4.5, -2.0}, {4.5, 2.0}, {9.5, 2.0}, {9.5, -2.0}}, ZoneKind::kRoom, 0.0},
      {"ramp \"A\"", {{5.5, 1.25}, {6.5, 1.25}, {6.5, 2.0}}, ZoneKind::kSlow, 0.35},
      {"lane", {{5.0, -2.0}, {7.0, -2.0}, {7.0, -1.0}, {5.0, -1.0}}, ZoneKind::kOneWay, 3.0}};
  return drawing;
}

inline bool same(const topomap::BranchPoint& a, const topomap::BranchPoint& b) {
  return a.position_m == b.position_m && a.clearance_m == b.clearance_m;
}

/// Equal to the last bit.
inline void expect_same(const topomap::GlobalMap& a, const topomap::GlobalMap& b) {
  EXPECT_EQ(a.version, b.version);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(a.nodes[i].id, b.nodes[i].id);
    EXPECT_EQ(a.nodes[i].kind, b.nodes[i].kind);
    EXPECT_EQ(a.nodes[i].position_m, b.nodes[i].position_m);
    EXPECT_EQ(a.nodes[i].clearance_m, b.nodes[i].clearance_m);
    EXPECT_EQ(a.nodes[i].observations, b.nodes[i].observations);
    EXPECT_EQ(a.nodes[i].last_seen_ns, b.nodes[i].last_seen_ns);
  }
  ASSERT_EQ(a.branches.size(), b.branches.size());
  for (std::size_t i = 0; i < a.branches.size(); ++i) {
    EXPECT_EQ(a.branches[i].id, b.branches[i].id);
    EXPECT_EQ(a.branches[i].node_a, b.branches[i].node_a);
    EXPECT_EQ(a.branches[i].node_b, b.branches[i].node_b);
    EXPECT_EQ(a.branches[i].is_virtual, b.branches[i].is_virtual);
    EXPECT_EQ(a.branches[i].observations, b.branches[i].observations);
    EXPECT_EQ(a.branches[i].last_seen_ns, b.branches[i].last_seen_ns);
    EXPECT_TRUE(std::ranges::equal(a.branches[i].points, b.branches[i].points, same));
  }
}

inline void expect_same_places(const storage::MapDrawing& a, const storage::MapDrawing& b) {
  ASSERT_EQ(a.places.size(), b.places.size());
  for (std::size_t i = 0; i < a.places.size(); ++i) {
    EXPECT_EQ(a.places[i].name, b.places[i].name);
    EXPECT_EQ(a.places[i].position_m, b.places[i].position_m);
    EXPECT_EQ(a.places[i].station_heading_rad, b.places[i].station_heading_rad);
  }
}

inline void expect_same_zones(const storage::MapDrawing& a, const storage::MapDrawing& b) {
  ASSERT_EQ(a.zones.size(), b.zones.size());
  for (std::size_t i = 0; i < a.zones.size(); ++i) {
    EXPECT_EQ(a.zones[i].name, b.zones[i].name);
    EXPECT_EQ(a.zones[i].polygon_m, b.zones[i].polygon_m);
    EXPECT_EQ(a.zones[i].kind, b.zones[i].kind);
    EXPECT_EQ(a.zones[i].value, b.zones[i].value);
  }
}

/// Free but for a frame of unknown cells; cells of 0.1 m from (-1, -3) to (11, 6).
inline planning::FreeSpace sample_space() {
  planning::GridFrame frame;
  frame.columns = 120;
  frame.rows = 90;
  frame.T_map_grid = {-1.0, -3.0, 0.0};
  planning::OccupancyGrid grid(frame, planning::CellState::kFree);
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    grid.set({0, row}, planning::CellState::kOccupied);
  }
  return planning::FreeSpace(std::move(grid));
}

/// A directory of its own for each test.
class ScratchTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::path(testing::TempDir()) / "topogeo_exchange_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    directory_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  static std::string content(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::filesystem::path write(const std::string& name,
                                            const std::string& bytes) const {
    std::ofstream(directory_ / name, std::ios::binary | std::ios::trunc) << bytes;
    return directory_ / name;
  }

  std::filesystem::path directory_;
};

/// Message of the exception that `call` throws; "" without one.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace topogeo::exchange
