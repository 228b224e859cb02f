// The hybrid map in transit: messages of map_store, and a reader's map from them.
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/service/hybrid_map_messages.hpp"
#include "topogeo/service/hybrid_map_mirror.hpp"

#include "map_store/hybrid_updates.hpp"
#include "planning/floors.hpp"

namespace topogeo {
namespace {

using planning::CellState;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::uint64_t kVersion = 100;

/// Instance handles like those of DDS: one for each key.
messaging::Handle handle_of(const msg::GridTile& tile) {
  messaging::Handle handle;
  handle.bytes[0] = static_cast<std::uint8_t>(tile.tile());
  handle.bytes[1] = static_cast<std::uint8_t>(tile.tile() >> 8U);
  return handle;
}

planning::HybridMap map_of(planning::OccupancyGrid grid, std::vector<planning::Place> places = {}) {
  const planning::FreeSpace space(std::move(grid), {1.5, false});
  return {space, planning::zones_by_width(space), std::move(places)};
}

/// Two rooms with a door between them, on 2 x 2 tiles; (column, row) is a pillar.
planning::HybridMap two_rooms(planning::Cell pillar, std::int32_t columns = 100) {
  planning::GridFrame frame;
  frame.columns = columns;
  frame.rows = 70;
  frame.T_map_grid = {-3.5, 1.25, 0.25};
  planning::OccupancyGrid grid(frame, CellState::kUnknown);
  planning::fill_box(grid, {2, 2}, {97, 67}, CellState::kOccupied);
  planning::fill_box(grid, {3, 3}, {96, 66}, CellState::kFree);
  planning::fill_box(grid, {50, 3}, {50, 30}, CellState::kOccupied);
  planning::fill_box(grid, {50, 40}, {50, 66}, CellState::kOccupied);
  grid.set(pillar, CellState::kOccupied);
  return map_of(std::move(grid), {{"left", {-2.0, 3.0}}, {"right", {1.0 / 3.0, 5.0}}});
}

void expect_same(const planning::HybridMap& a, const planning::HybridMap& b) {
  EXPECT_EQ(a.frame().columns, b.frame().columns);
  EXPECT_EQ(a.frame().rows, b.frame().rows);
  EXPECT_EQ(a.frame().resolution_m, b.frame().resolution_m);
  EXPECT_EQ(a.frame().T_map_grid, b.frame().T_map_grid);
  EXPECT_EQ(a.space().inflation().forbidden_cells, b.space().inflation().forbidden_cells);
  EXPECT_EQ(a.space().inflation().inflate_unknown, b.space().inflation().inflate_unknown);
  EXPECT_EQ(a.space().inflation().min_pocket_m2, b.space().inflation().min_pocket_m2);
  EXPECT_TRUE(std::ranges::equal(a.space().grid().cells(), b.space().grid().cells()));
  EXPECT_TRUE(std::ranges::equal(a.space().seen().cells(), b.space().seen().cells()));
  EXPECT_EQ(a.space().rules().lines(), b.space().rules().lines());
  EXPECT_EQ(a.zones().zone_of_cell, b.zones().zone_of_cell);
  ASSERT_EQ(a.zones().zones.size(), b.zones().zones.size());
  for (std::size_t i = 0; i < a.zones().zones.size(); ++i) {
    const planning::Zone& left = a.zones().zones[i];
    const planning::Zone& right = b.zones().zones[i];
    EXPECT_EQ(left.id, right.id);
    EXPECT_EQ(left.name, right.name);
    EXPECT_EQ(left.cells, right.cells);
    EXPECT_EQ(left.room, right.room);
    EXPECT_EQ(left.box.low, right.box.low);
    EXPECT_EQ(left.box.high, right.box.high);
  }
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  for (std::size_t i = 0; i < a.nodes().size(); ++i) {
    EXPECT_EQ(a.nodes()[i].position_m, b.nodes()[i].position_m);
    EXPECT_EQ(a.nodes()[i].zones, b.nodes()[i].zones);
    EXPECT_EQ(a.nodes()[i].clearance_m, b.nodes()[i].clearance_m);
  }
  ASSERT_EQ(a.edges().size(), b.edges().size());
  for (std::size_t i = 0; i < a.edges().size(); ++i) {
    EXPECT_EQ(a.edges()[i].cost_m, b.edges()[i].cost_m);
    EXPECT_EQ(a.edges()[i].route, b.edges()[i].route);
  }
  ASSERT_EQ(a.places().size(), b.places().size());
  for (std::size_t i = 0; i < a.places().size(); ++i) {
    EXPECT_EQ(a.places()[i].name, b.places()[i].name);
    EXPECT_EQ(a.places()[i].position_m, b.places()[i].position_m);
    EXPECT_EQ(a.places()[i].station_heading_rad, b.places()[i].station_heading_rad);
  }
}

void put_all(service::HybridMapMirror& mirror, const service::HybridMapMessages& messages) {
  for (const msg::GridTile& tile : messages.tiles) mirror.put(tile, handle_of(tile));
  mirror.put(messages.summary);
}

TEST(HybridMapMessages, AMapComesBackToTheLastBit) {
  const planning::BlockFloor floor = planning::block_floor({}, 3);
  const std::vector<planning::DrawnLine> lines{
      {planning::LineKind::kWall, {{0.5, 0.5}, {2.0, 3.5}, {4.0, 3.0}}},
      {planning::LineKind::kOpening, {{5.05, 0.5}, {5.05, 3.5}}},
      {planning::LineKind::kDoor, {{10.05, 0.5}, {10.05, 3.5}}, "door"}};
  const planning::FreeSpace space(floor.grid, {3.0, true, 0.75}, {}, lines);
  planning::ZoneMap zones = planning::drawn_zones(space, floor.rooms);
  for (planning::Zone& zone : zones.zones) zone.room = zone.id + 5U;
  const planning::HybridMap map(space, zones, {{"a", {1.0, 2.0}}, {"b", {2.0, 2.0}, -0.5}});
  ASSERT_GT(map.edges().size(), 5U);
  const auto messages = service::to_messages(map, "robot", 7, kVersion);
  EXPECT_EQ(messages.tiles.size(), 4U * 2U);
  EXPECT_EQ(messages.summary.stamp_ns(), 7);
  EXPECT_EQ(messages.summary.nodes().size(), map.nodes().size());
  EXPECT_EQ(messages.summary.edges().size(), map.edges().size());
  service::HybridMapMirror mirror;
  put_all(mirror, messages);
  ASSERT_NE(mirror.map(), nullptr);
  expect_same(*mirror.map(), map);
  EXPECT_EQ(mirror.version(), kVersion);
}

// A wall splits the drawn zone, whose name has the maximum length.
TEST(HybridMapMessages, ThePartsOfAZoneWithALongNameHaveRoomForTheirNumber) {
  planning::GridFrame frame;
  frame.columns = 100;
  frame.rows = 40;
  planning::OccupancyGrid grid(frame, CellState::kFree);
  planning::fill_box(grid, {60, 0}, {60, 39}, CellState::kOccupied);
  const planning::FreeSpace space(std::move(grid), {1.5, false});
  const auto names_of = [&](const std::string& name) {
    const std::vector<planning::DrawnZone> drawn{{name, {{0, 0}, {10, 0}, {10, 4}, {0, 4}}}};
    const planning::HybridMap map(space, planning::drawn_zones(space, drawn));
    std::vector<std::string> names;
    const auto messages = service::to_messages(map, "robot", 0, kVersion);
    for (const msg::HybridZone& zone : messages.summary.zones()) {
      names.push_back(zone.name().to_string());
    }
    return names;
  };
  EXPECT_THAT(names_of("hall"), testing::ElementsAre("hall", "hall 2"));
  const std::string longest(64, 'a');
  EXPECT_THAT(names_of(longest), testing::ElementsAre(longest, std::string(62, 'a') + " 2"));
  std::string umlauts = "a";
  for (int i = 0; i < 31; ++i) umlauts += "\u00e4";
  EXPECT_THAT(names_of(umlauts + "b"),
              testing::ElementsAre(umlauts + "b", umlauts.substr(0, 61) + " 2"));
  EXPECT_THAT([&] { names_of(longest + "b"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("zone: 'aaa")));
}

TEST(HybridMapMessages, CellsBeyondTheGridAreUnknown) {
  const auto messages = service::to_messages(two_rooms({20, 20}), "robot", 0, kVersion);
  ASSERT_EQ(messages.tiles.size(), 4U);
  EXPECT_EQ(messages.tiles[1].states()[35], 2) << "column 99, the last";
  EXPECT_EQ(messages.tiles[1].states()[36], 2);
  EXPECT_EQ(messages.tiles[1].zones()[40], msg::kNoZone);
  EXPECT_EQ(messages.tiles[2].states()[2 * 64 + 10], 0) << "row 66";
  EXPECT_EQ(messages.tiles[2].states()[7 * 64 + 10], 2) << "row 71, beyond";
}

// Four tiles and the summary, in all 120 orders: the map is complete with the last of them, never
// before.
TEST(HybridMapMirror, TakesThePartsInAnyOrder) {
  const planning::HybridMap map = two_rooms({20, 20});
  const auto messages = service::to_messages(map, "robot", 0, kVersion);
  std::array<std::size_t, 5> order{0, 1, 2, 3, 4};
  do {
    service::HybridMapMirror mirror;
    for (std::size_t i = 0; i < order.size(); ++i) {
      EXPECT_EQ(mirror.map(), nullptr);
      EXPECT_EQ(mirror.version(), 0U);
      if (order[i] == 4) {
        mirror.put(messages.summary);
      } else {
        const msg::GridTile& tile = messages.tiles[order[i]];
        mirror.put(tile, handle_of(tile));
      }
    }
    const auto got = mirror.map();
    ASSERT_NE(got, nullptr);
    EXPECT_EQ(got->zones().zone_of_cell, map.zones().zone_of_cell);
  } while (std::ranges::next_permutation(order).found);
}

TEST(HybridMapMirror, BuildsOncePerChange) {
  const auto messages = service::to_messages(two_rooms({20, 20}), "robot", 0, kVersion);
  service::HybridMapMirror mirror;
  put_all(mirror, messages);
  const auto first = mirror.map();
  EXPECT_EQ(mirror.map(), first);
  mirror.put(messages.summary);  // repeated
  EXPECT_NE(mirror.map(), nullptr);
}

// While an update arrives, in any order, the previous map stays whole.
TEST(HybridMapMirror, KeepsTheOldMapWhileTheNextComes) {
  map_store::HybridUpdates updates("robot", kVersion);
  const planning::HybridMap before = two_rooms({20, 20});
  const planning::HybridMap after = two_rooms({80, 66});
  const auto first = updates.update_to(before, 1);
  for (const auto& tile : first.changed) updates.sent(tile);
  updates.sent(*first.summary);
  const auto second = updates.update_to(after, 2);
  ASSERT_GE(second.changed.size(), 2U) << "the pillar went from one tile to another";
  std::vector<std::size_t> order(second.changed.size() + 1);
  std::iota(order.begin(), order.end(), std::size_t{0});
  do {
    service::HybridMapMirror mirror;
    for (const auto& tile : first.changed) mirror.put(tile, handle_of(tile));
    mirror.put(*first.summary);
    const auto old = mirror.map();
    ASSERT_NE(old, nullptr);
    for (const std::size_t part : order) {
      EXPECT_EQ(mirror.map(), old);
      EXPECT_EQ(mirror.version(), kVersion + 1);
      if (part == second.changed.size()) {
        mirror.put(*second.summary);
      } else {
        mirror.put(second.changed[part], handle_of(second.changed[part]));
      }
    }
    const auto got = mirror.map();
    ASSERT_NE(got, old);
    EXPECT_EQ(mirror.version(), kVersion + 2);
    EXPECT_TRUE(std::ranges::equal(got->space().grid().cells(), after.space().grid().cells()));
    // A planner that still uses the old map can continue.
    EXPECT_TRUE(std::ranges::equal(old->space().grid().cells(), before.space().grid().cells()));
  } while (std::ranges::next_permutation(order).found);
}

TEST(HybridMapMirror, FollowsAGridThatShrinks) {
  map_store::HybridUpdates updates("robot", kVersion);
  service::HybridMapMirror mirror;
  const auto send = [&](const planning::HybridMap& map) {
    auto update = updates.update_to(map, 1);
    for (const auto& tile : update.gone) {
      mirror.remove(handle_of(tile));
      updates.disposed(tile);
    }
    for (const auto& tile : update.changed) {
      mirror.put(tile, handle_of(tile));
      updates.sent(tile);
    }
    if (update.summary) {
      mirror.put(*update.summary);
      updates.sent(*update.summary);
    }
    return update;
  };
  const planning::HybridMap wide = two_rooms({20, 20}, 140);
  const planning::HybridMap narrow = two_rooms({20, 20}, 100);
  EXPECT_EQ(send(wide).changed.size(), 6U);
  expect_same(*mirror.map(), wide);
  EXPECT_EQ(send(narrow).gone.size(), 2U);
  expect_same(*mirror.map(), narrow);
  send(wide);
  expect_same(*mirror.map(), wide);
}

TEST(HybridMapMirror, WithoutATileOrASummaryThereIsNoNewMap) {
  const auto messages = service::to_messages(two_rooms({20, 20}), "robot", 0, kVersion);
  service::HybridMapMirror mirror;
  put_all(mirror, messages);
  mirror.remove(handle_of(messages.tiles[3]));
  EXPECT_EQ(mirror.map(), nullptr);
  mirror.remove(handle_of(messages.tiles[3]));  // repeated: no error
  mirror.put(messages.tiles[3], handle_of(messages.tiles[3]));
  EXPECT_NE(mirror.map(), nullptr);
  mirror.remove_summary();
  EXPECT_EQ(mirror.map(), nullptr);
  EXPECT_EQ(mirror.version(), 0U);
  mirror.put(messages.summary);
  EXPECT_NE(mirror.map(), nullptr);
}

TEST(HybridMapMirror, RefusesNonsenseAndStaysAsItWas) {
  const auto good = service::to_messages(two_rooms({20, 20}), "robot", 0, kVersion);
  service::HybridMapMirror mirror;
  put_all(mirror, good);
  const auto map = mirror.map();
  const auto tile_refused = [&](auto change, const char* message) {
    msg::GridTile tile = good.tiles[1];
    change(tile);
    EXPECT_THAT([&] { mirror.put(tile, handle_of(tile)); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
  };
  tile_refused([](auto& t) { t.states().pop_back(); }, "states: expected 4096");
  tile_refused([](auto& t) { t.zones().push_back(0); }, "zones: expected 4096");
  tile_refused([](auto& t) { t.states()[9] = 3; }, "state of a cell: expected 0 to 2");
  tile_refused([](auto& t) { t.tile(msg::kMaxTiles); }, "tile: expected less than 16384");
  const auto refused = [&](auto change, const char* message) {
    msg::HybridMap summary = good.summary;
    change(summary);
    EXPECT_THAT([&] { mirror.put(summary); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](auto& s) { s.columns(0); }, "columns is 0");
  refused([](auto& s) { s.rows(4000000000U); }, "rows is");
  refused([&](auto& s) { s.resolution_m(nan); }, "resolution_m is");
  refused([&](auto& s) { s.T_map_grid().x_m(nan); }, "x_m is nan");
  refused([&](auto& s) { s.forbidden_cells(nan); }, "forbidden_cells' = 'nan'");
  refused([](auto& s) { s.tile_versions().pop_back(); }, "tile_versions: expected 4");
  refused([](auto& s) { s.columns(200); }, "tile_versions: expected 8");
  refused([](auto& s) { s.places()[1].name("left"); }, "place 'left'");
  refused([](auto& s) { s.places()[1].name(""); }, "place ''");
  refused([&](auto& s) { s.places()[0].position().y_m(nan); }, "position of a place is nan");
  refused([&](auto& s) { s.places()[0].heading_rad(nan); }, "heading of a place");
  refused([&](auto& s) { s.pocket_m2(nan); }, "min_pocket_m2");
  refused([&](auto& s) { s.zones()[0].area_m2(nan); }, "area of a zone is nan");
  refused([](auto& s) { s.nodes()[0].zone_b(9); }, "zone of a node: expected less than 2");
  refused([&](auto& s) { s.nodes()[0].clearance_m(nan); }, "clearance of a node");
  refused(
      [](auto& s) {
        s.edges().resize(1);
        s.edges()[0].node_b(5);
      },
      "node of an edge: expected less than 1");
  EXPECT_EQ(mirror.map(), map);
}

// Parts that are valid alone but contradict each other.
TEST(HybridMapMirror, RefusesOnceAWholeMapThatContradictsItself) {
  const auto good = service::to_messages(two_rooms({20, 20}), "robot", 0, kVersion);
  service::HybridMapMirror mirror;
  put_all(mirror, good);
  const auto map = mirror.map();
  const auto refused = [&](auto change, const char* message) {
    msg::GridTile tile = good.tiles[0];
    change(tile.zones()[30 * 64 + 30]);
    mirror.put(tile, handle_of(tile));
    EXPECT_THAT([&] { mirror.map(); }, ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
    EXPECT_EQ(mirror.map(), map) << "the one before stays";
  };
  refused([](std::uint16_t& zone) { zone = 7; }, "zone of a cell: expected less than 2");
  refused([](std::uint16_t& zone) { zone = msg::kNoZone; }, "is passable without a zone");
  mirror.put(good.tiles[0], handle_of(good.tiles[0]));
  EXPECT_NE(mirror.map(), nullptr);
}

TEST(HybridUpdates, OnlyChangedTilesTravel) {
  map_store::HybridUpdates updates("robot", kVersion);
  const auto first = updates.update_to(two_rooms({20, 20}), 1);
  ASSERT_EQ(first.changed.size(), 4U);
  for (const auto& tile : first.changed) updates.sent(tile);
  updates.sent(*first.summary);
  EXPECT_EQ(updates.count(), 4U);
  EXPECT_TRUE(updates.update_to(two_rooms({20, 20}), 2).empty());

  const auto second = updates.update_to(two_rooms({21, 20}), 3);
  ASSERT_EQ(second.changed.size(), 1U);
  EXPECT_EQ(second.changed[0].tile(), 0U);
  EXPECT_EQ(second.changed[0].version(), kVersion + 2);
  EXPECT_EQ(second.changed[0].sequence_number(), 4U);
  EXPECT_EQ(second.summary->version(), kVersion + 2);
  EXPECT_EQ(second.summary->sequence_number(), 1U);
  EXPECT_EQ(second.summary->tile_versions(),
            (std::vector<std::uint64_t>{kVersion + 2, kVersion + 1, kVersion + 1, kVersion + 1}));
}

TEST(HybridUpdates, APlaceAloneIsAChange) {
  map_store::HybridUpdates updates("robot", kVersion);
  planning::GridFrame frame;
  frame.columns = frame.rows = 10;
  const planning::OccupancyGrid grid(frame, CellState::kFree);
  const auto first = updates.update_to(map_of(grid), 1);
  updates.sent(first.changed.at(0));
  updates.sent(*first.summary);
  const auto second = updates.update_to(map_of(grid, {{"a", {0.5, 0.5}}}), 1);
  EXPECT_TRUE(second.changed.empty());
  ASSERT_TRUE(second.summary.has_value());
  EXPECT_EQ(second.summary->version(), kVersion + 2);
}

TEST(HybridUpdates, WhatWasSentInPartIsNeverTakenForTheNext) {
  map_store::HybridUpdates updates("robot", kVersion);
  const auto first = updates.update_to(two_rooms({20, 20}), 1);
  service::HybridMapMirror mirror;
  for (const auto& tile : first.changed) {
    updates.sent(tile);
    mirror.put(tile, handle_of(tile));
  }
  // The summary could not be sent, and the map has changed since.
  const auto second = updates.update_to(two_rooms({21, 20}), 1);
  ASSERT_EQ(second.changed.size(), 1U);
  mirror.put(*second.summary);
  EXPECT_EQ(mirror.map(), nullptr) << "tile 0 is of the first update";
  mirror.put(second.changed[0], handle_of(second.changed[0]));
  expect_same(*mirror.map(), two_rooms({21, 20}));
}

}  // namespace
}  // namespace topogeo
