// Zones as a zone set of VDA 5050 and as masks of costmap filters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/masks.hpp"
#include "topogeo/exchange/zone_set.hpp"

#include "readers.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using planning::ZoneKind;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class ZoneFiles : public ScratchTest {
 protected:
  static std::string sample_set() {
    return zone_set_text(sample_drawing().zones, {"floor 1", "L1", "topogeo", "robot 1", 0});
  }
};

TEST_F(ZoneFiles, AZoneSetReadsBackToTheLastDigit) {
  const ZoneSet set = parse_zone_set(sample_set(), "f");
  storage::MapDrawing expected = sample_drawing();
  expected.places.clear();
  // Counter-clockwise, from the same corner.
  expected.zones[1].polygon_m = {{4.5, -2.0}, {9.5, -2.0}, {9.5, 2.0}, {4.5, 2.0}};
  storage::MapDrawing read;
  read.zones = set.zones;
  expect_same_zones(read, expected);
  EXPECT_THAT(set.notes, IsEmpty());
}

TEST_F(ZoneFiles, AZoneSetKeepsTheRulesOfVda5050) {
  EXPECT_EQ(run_reader({"zones", write("zones.json", sample_set())}),
            "floor_1 BLOCKED ACTION SPEED_LIMIT DIRECTED\n");
}

TEST_F(ZoneFiles, APreferredLaneIsAZoneOfPriority) {
  const std::vector<planning::DrawnZone> lane = {
      {"lane", {{0, 0}, {4, 0}, {4, 1}}, ZoneKind::kPreferred, 0.0}};
  std::string text = zone_set_text(lane, {});
  EXPECT_THAT(text, HasSubstr("\"PRIORITY\""));
  const ZoneSet same = parse_zone_set(text, "f");
  ASSERT_EQ(same.zones.size(), 1U);
  EXPECT_EQ(same.zones[0].kind, ZoneKind::kPreferred);
  EXPECT_THAT(same.notes, IsEmpty());
  const std::size_t factor = text.find("1.0", text.find("priorityFactor"));
  text.replace(factor, 3, "0.5");
  EXPECT_THAT(parse_zone_set(text, "f").notes,
              Contains("zone 'lane': its priority 0.5 counts as 1"));
}

TEST_F(ZoneFiles, TheIdOfASetFollowsFromItsContentAlone) {
  const auto id = [](const std::string& text) {
    const std::size_t at = text.find("zoneSetId");
    return text.substr(at, text.find(',', at) - at);
  };
  const ExportHeader header{"m", "", "t", "r", 5};
  auto zones = sample_drawing().zones;
  const std::string before = zone_set_text(zones, header);
  EXPECT_EQ(id(before), id(zone_set_text(zones, {"m", "", "t", "other", 6})));
  zones[2].value = 0.36;
  EXPECT_NE(id(before), id(zone_set_text(zones, header)));
}

TEST_F(ZoneFiles, RefusesWhatVda5050Forbids) {
  const std::vector<planning::DrawnZone> bow = {
      {"bow", {{0, 0}, {4, 4}, {4, 0}, {0, 4}}, ZoneKind::kNoGo, 0.0}};
  EXPECT_EQ(error_of([&] { zone_set_text(bow, {}); }),
            "zone 'bow': its border crosses or touches itself");
  std::vector<planning::DrawnZone> lanes = {
      {"east", {{0, 0}, {4, 0}, {4, 4}, {0, 4}}, ZoneKind::kOneWay, 0.0},
      {"west", {{3, 3}, {6, 3}, {6, 6}, {3, 6}}, ZoneKind::kOneWay, 3.0}};
  EXPECT_THAT(error_of([&] { zone_set_text(lanes, {}); }), HasSubstr("'east' and 'west'"));
  lanes[1].kind = ZoneKind::kSlow;
  EXPECT_EQ(error_of([&] { zone_set_text(lanes, {}); }), "");
}

TEST_F(ZoneFiles, ForeignZonesOfOtherTypesAreLeftOutWithANote) {
  const ZoneSet set = parse_zone_set(R"({"mapId":"m","zoneSetId":"s","zones":[
{"zoneId":"z1","zoneType":"PENALTY","penaltyFactor":0.5,"vertices":[{"x":0,"y":0},{"x":1,"y":0},{"x":1,"y":1}]},
{"zoneId":"z2","zoneType":"ACTION","entryActions":[{"actionType":"beep"}],"vertices":[{"x":0,"y":0},{"x":1,"y":0},{"x":1,"y":1}]},
{"zoneId":"z3","zoneType":"BLOCKED","zoneDescriptor":"z2","vertices":[{"x":0,"y":0},{"x":1,"y":0},{"x":1,"y":1}]}]})",
                                     "f");
  ASSERT_EQ(set.zones.size(), 2U);
  EXPECT_EQ(set.zones[1].name, "z3");  // the name was taken
  EXPECT_THAT(set.notes, Contains("zone 'z1' left out: no zone kind corresponds to PENALTY"));
  EXPECT_THAT(set.notes, Contains("zone 'z2': its actions are left out"));
}

TEST_F(ZoneFiles, NamesWhatIsWrong) {
  const auto error = [](const std::string& zone) {
    return error_of([&] { parse_zone_set(R"({"zoneSet":{"zones":[)" + zone + "]}}", "f"); });
  };
  EXPECT_EQ(error("{}"), "f: zoneSet.zones[0].zoneId: expected a value, got nothing");
  EXPECT_EQ(error(R"({"zoneId":"a","zoneType":"SPEED_LIMIT","vertices":[]})"),
            "f: zoneSet.zones[0].maximumSpeed: expected a value, got nothing");
  EXPECT_EQ(
      error(R"({"zoneId":"a","zoneType":"BLOCKED","vertices":[{"x":0,"y":0}]})"),
      "f: zoneSet.zones[0].vertices: expected three corners or more, got [{\"x\":0,\"y\":0}]");
}

TEST_F(ZoneFiles, ZonesThatCannotBeAreRefused) {
  const auto error = [](const std::string& zone) {
    return error_of([&] { parse_zone_set(R"({"zoneSet":{"zones":[)" + zone + "]}}", "f"); });
  };
  const std::string square =
      R"("vertices":[{"x":0,"y":0},{"x":2,"y":0},{"x":2,"y":2},{"x":0,"y":2}]})";
  for (const char* speed : {"0", "-1", "30"}) {
    EXPECT_THAT(error(R"({"zoneId":"a","zoneType":"SPEED_LIMIT","maximumSpeed":)" +
                      std::string(speed) + "," + square),
                HasSubstr("maximumSpeed: expected 0.01 to 10 m/s, got " + std::string(speed)));
  }
  EXPECT_THAT(error(R"({"zoneId":"a","zoneType":"DIRECTED","direction":90,)" + square),
              HasSubstr("direction: expected -3.14159 to 3.14159 rad, got 90"));
  EXPECT_THAT(
      error(
          R"({"zoneId":"a","zoneType":"BLOCKED","vertices":[{"x":0,"y":0},{"x":2,"y":2},{"x":2,"y":0},{"x":0,"y":2}]})"),
      HasSubstr("expected a border that neither crosses nor touches itself"));
}

TEST_F(ZoneFiles, AClosedBorderIsOpenedAndCanBeWrittenAgain) {
  const ZoneSet set = parse_zone_set(
      R"({"zones":[{"zoneId":"a","zoneType":"BLOCKED","vertices":[{"x":0,"y":0},{"x":2,"y":0},{"x":2,"y":2},{"x":0,"y":0}]}]})",
      "f");
  ASSERT_EQ(set.zones.size(), 1U);
  EXPECT_EQ(set.zones[0].polygon_m.size(), 3U);
  EXPECT_NO_THROW(static_cast<void>(zone_set_text(set.zones, {})));
}

planning::GridFrame mask_frame() {
  planning::GridFrame frame;
  frame.columns = 6;
  frame.rows = 4;
  frame.resolution_m = 0.5;
  return frame;
}

TEST_F(ZoneFiles, MasksHaveTheCellsThatZonesTouch) {
  // The stairs touch two columns of two rows; the two slow zones share a cell.
  const std::vector<planning::DrawnZone> zones = {
      {"stairs", {{0.6, 0.6}, {1.4, 0.6}, {1.4, 1.4}, {0.6, 1.4}}, ZoneKind::kNoGo, 0.0},
      {"ramp", {{2.1, 0.1}, {2.9, 0.1}, {2.9, 0.4}, {2.1, 0.4}}, ZoneKind::kSlow, 0.29},
      {"door", {{2.6, 0.2}, {2.7, 0.2}, {2.7, 1.2}}, ZoneKind::kSlow, 0.5},
      {"post", {{0.1, 1.7}, {0.2, 1.7}, {0.2, 1.8}}, ZoneKind::kNoGo, 0.0},
      {"room", {{0, 0}, {3, 0}, {3, 2}}, ZoneKind::kRoom, 0.0}};
  const MaskFiles masks = mask_files(directory_ / "floor.yaml", mask_frame(), zones);
  EXPECT_THAT(masks.notes, IsEmpty());
  write_files(masks.files);
  EXPECT_EQ(run_reader({"grid", directory_ / "floor_keepout.yaml"}),
            "6 4 0.5 0 0\n"
            "0 0 0 0 0 0 0 100 100 0 0 0 0 100 100 0 0 0 100 0 0 0 0 0\n");
  EXPECT_EQ(run_reader({"grid", directory_ / "floor_speed.yaml"}),
            "6 4 0.5 0 0\n"
            "0 0 0 0 29 29 0 0 0 0 0 50 0 0 0 0 0 50 0 0 0 0 0 0\n");
  EXPECT_THAT(content(directory_ / "floor_speed.yaml"),
              HasSubstr("# CostmapFilterInfo: type 2 (speed in m/s), base 0.0, multiplier 0.01\n"));
  // Our reader accepts them unchanged.
  EXPECT_EQ(read_grid_image(directory_ / "floor_keepout.yaml").values[7], 100);
}

TEST_F(ZoneFiles, FastZonesHaveCoarserSteps) {
  const std::vector<planning::DrawnZone> zones = {
      {"yard", {{0, 0}, {3, 0}, {3, 2}, {0, 2}}, ZoneKind::kSlow, 2.5},
      {"gate", {{0.1, 0.1}, {0.2, 0.1}, {0.2, 0.2}}, ZoneKind::kSlow, 0.2}};
  const MaskFiles masks = mask_files(directory_ / "yard", mask_frame(), zones);
  EXPECT_THAT(masks.files[3].bytes, HasSubstr("multiplier 0.025\n"));
  write_files(masks.files);
  // 0.2 / 0.025 = 8; the rest may drive at 2.5 m/s.
  EXPECT_EQ(read_grid_image(directory_ / "yard_speed.yaml").values[0], 8);
  EXPECT_EQ(read_grid_image(directory_ / "yard_speed.yaml").values[10], 100);
}

TEST_F(ZoneFiles, ZonesBeyondTheGridAndDirectionsAreNoted) {
  const std::vector<planning::DrawnZone> zones = {
      {"yard", {{1, 1}, {9, 1}, {9, 2}}, ZoneKind::kNoGo, 0.0},
      {"lane", {{0, 0}, {1, 0}, {1, 1}}, ZoneKind::kOneWay, 0.0}};
  const MaskFiles masks = mask_files("m", mask_frame(), zones);
  EXPECT_THAT(masks.notes, Contains("zone 'yard' reaches beyond the grid and is clipped"));
  EXPECT_THAT(masks.notes, Contains("zone 'lane': masks have no directions"));
}

}  // namespace
}  // namespace topogeo::exchange
