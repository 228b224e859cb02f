// Effects of orders on the drawing of a map.
#include "map_store/drawing_order.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/service/drawing_conversions.hpp"

namespace topogeo::map_store {
namespace {

using testing::HasSubstr;

storage::MapDrawing drawn() {
  storage::MapDrawing drawing;
  drawing.places = {{"kitchen", {1.0, 2.0}}, {"base station", {0.5, 0.5}, -1.5}};
  drawing.zones = {{"hall", {{0, 0}, {4, 0}, {4, 3}}},
                   {"ramp", {{5, 0}, {6, 0}, {6, 1}}, planning::ZoneKind::kSlow, 0.3}};
  drawing.lines = {{planning::LineKind::kWall, {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}}},
                   {planning::LineKind::kOpening, {{4, 1}, {4, 2}}},
                   {planning::LineKind::kDoor, {{0, 1}, {0, 2}}, "front door"}};
  return drawing;
}

storage::MapDrawing with_grid(std::uint64_t version) {
  storage::MapDrawing now;
  now.places = {{"old", {0.0, 0.0}}};
  planning::GridFrame frame;
  frame.columns = frame.rows = 3;
  now.grid.emplace(frame);
  now.version = version;
  return now;
}

msg::DrawingOrder order_of(const storage::MapDrawing& drawing, std::uint64_t version) {
  msg::DrawingOrder order;
  order.version(version);
  order.content(service::to_msg(drawing));
  return order;
}

TEST(DrawingMessages, ComeBackAsTheyWere) {
  const storage::MapDrawing back = service::from_msg(service::to_msg(drawn()));
  const storage::MapDrawing expected = drawn();
  EXPECT_EQ(back.places, expected.places);
  ASSERT_EQ(back.zones.size(), 2U);
  EXPECT_EQ(back.zones[1].name, "ramp");
  EXPECT_EQ(back.zones[1].value, 0.3);
  EXPECT_EQ(back.zones[1].kind, planning::ZoneKind::kSlow);
  EXPECT_EQ(back.zones[1].polygon_m, expected.zones[1].polygon_m);
  EXPECT_EQ(back.lines, expected.lines);
}

TEST(DrawingMessages, WhatCannotBeIsRefused) {
  const auto refused = [](auto change) {
    msg::DrawingContent content = service::to_msg(drawn());
    change(content);
    EXPECT_ANY_THROW(service::from_msg(content));
  };
  refused([](auto& c) { c.zones()[0].kind(5); });
  refused([](auto& c) { c.lines()[0].kind(3); });
  refused([](auto& c) { c.zones()[1].value(0.0); });
  refused([](auto& c) { c.zones()[0].corners().resize(2); });
  refused([](auto& c) { c.zones()[0].corners()[0].x_m(std::numeric_limits<double>::infinity()); });
  refused([](auto& c) { c.lines()[1].points().resize(3); });
  refused([](auto& c) { c.lines()[2].name(""); });
  refused([](auto& c) { c.places()[1].name(c.places()[0].name()); });
  refused([](auto& c) { c.places()[1].heading_rad(7.0); });
}

TEST(DrawingOrder, TheWholeDrawingIsReplacedButItsGrid) {
  const storage::MapDrawing now = with_grid(7);
  const DrawingOutcome outcome = carry_out(order_of(drawn(), 7), now, 0.1);
  EXPECT_EQ(outcome.result, msg::kDrawingDone) << outcome.message;
  ASSERT_TRUE(outcome.drawing);
  EXPECT_EQ(outcome.drawing->version, 8U);
  EXPECT_EQ(outcome.drawing->places, drawn().places);
  EXPECT_EQ(outcome.drawing->lines, drawn().lines);
  ASSERT_TRUE(outcome.drawing->grid);
  EXPECT_EQ(outcome.drawing->grid->frame().columns, 3);
}

TEST(DrawingOrder, AnotherVersionIsRefused) {
  for (const std::uint64_t version : {6U, 8U}) {
    const DrawingOutcome outcome = carry_out(order_of(drawn(), version), with_grid(7), 0.1);
    EXPECT_EQ(outcome.result, msg::kDrawingOtherVersion);
    EXPECT_THAT(outcome.message, HasSubstr("another client saved"));
    EXPECT_FALSE(outcome.drawing);
  }
}

TEST(DrawingOrder, WhatIsWrongIsNamed) {
  msg::DrawingOrder order = order_of(drawn(), 7);
  order.content().zones()[1].corners().resize(1);
  const DrawingOutcome outcome = carry_out(order, with_grid(7), 0.1);
  EXPECT_EQ(outcome.result, msg::kDrawingInvalid);
  EXPECT_THAT(outcome.message, HasSubstr("zones[1]: zone 'ramp': 1 corners"));
  EXPECT_FALSE(outcome.drawing);
}

TEST(DrawingOrder, AFloorBecomesTheGrid) {
  msg::DrawingOrder order = order_of(drawn(), 7);
  order.kind(msg::kDrawingFloor);
  order.inside().x_m(2.0);
  order.inside().y_m(2.0);
  const DrawingOutcome outcome = carry_out(order, with_grid(7), 0.1);
  ASSERT_TRUE(outcome.drawing) << outcome.message;
  const planning::OccupancyGrid& grid = *outcome.drawing->grid;
  const auto at = [&](double x_m, double y_m) {
    return grid.at(grid.frame().cell_of({x_m, y_m}).value());
  };
  EXPECT_EQ(at(2.0, 2.0), planning::CellState::kFree);
  EXPECT_EQ(at(4.05, 3.0), planning::CellState::kOccupied);
  EXPECT_EQ(at(4.05, 1.5), planning::CellState::kFree) << "the opening";
  ASSERT_EQ(outcome.drawing->lines.size(), 1U) << "the door, where rooms meet";
  EXPECT_EQ(outcome.drawing->lines[0].name, "front door");
  order.inside().x_m(4.05);
  order.inside().y_m(3.5);
  EXPECT_EQ(carry_out(order, with_grid(7), 0.1).result, msg::kDrawingInvalid);
  order.inside().x_m(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(carry_out(order, with_grid(7), 0.1).result, msg::kDrawingInvalid);
}

/// 40 x `rows` cubicles of 4 m with two walls each; the first ones have a door to the left.
storage::MapDrawing office(int rows, int doors) {
  storage::MapDrawing drawing;
  for (int i = 0; i < 40 * rows; ++i) {
    const int row = i / 40;
    const double x_m = 4.0 * (i % 40);
    const double y_m = 4.0 * row;
    drawing.lines.push_back({planning::LineKind::kWall, {{x_m, y_m}, {x_m + 4.0, y_m}}});
    drawing.lines.push_back({planning::LineKind::kWall, {{x_m, y_m}, {x_m, y_m + 4.0}}});
    if (i >= doors) continue;
    drawing.lines.push_back({planning::LineKind::kDoor,
                             {{x_m, y_m + 1.0}, {x_m, y_m + 2.0}},
                             "door " + std::to_string(i)});
  }
  return drawing;
}

TEST(DrawingOrder, AFloorOfThousandsOfWallsBecomesTheGrid) {
  msg::DrawingOrder order = order_of(office(50, 96), 7);
  const DrawingOutcome over = carry_out(order, with_grid(7), 0.2);
  EXPECT_EQ(over.result, msg::kDrawingInvalid) << "as walls over a map they are rules of it";
  EXPECT_THAT(over.message, HasSubstr("4096 zones with a rule"));
  order.kind(msg::kDrawingFloor);
  order.inside().x_m(2.0);
  order.inside().y_m(2.0);
  const DrawingOutcome outcome = carry_out(order, with_grid(7), 0.2);
  ASSERT_TRUE(outcome.drawing) << outcome.message;
  EXPECT_EQ(outcome.drawing->lines.size(), 96U) << "its doors";
  const planning::OccupancyGrid& grid = *outcome.drawing->grid;
  EXPECT_EQ(grid.at(grid.frame().cell_of({42.0, 2.0}).value()), planning::CellState::kFree);
  EXPECT_EQ(grid.at(grid.frame().cell_of({82.0, 82.0}).value()), planning::CellState::kUnknown)
      << "no door leads there";
  EXPECT_EQ(grid.at(grid.frame().cell_of({82.0, 80.1}).value()), planning::CellState::kOccupied);
}

TEST(DrawingOrder, AFloorHasNoMoreDoorsThanAMapHasRules) {
  msg::DrawingOrder order = order_of(office(7, 257), 7);
  order.kind(msg::kDrawingFloor);
  order.inside().x_m(2.0);
  order.inside().y_m(2.0);
  const DrawingOutcome outcome = carry_out(order, with_grid(7), 0.2);
  EXPECT_EQ(outcome.result, msg::kDrawingInvalid);
  EXPECT_THAT(outcome.message, HasSubstr("257 zones"));
}

}  // namespace
}  // namespace topogeo::map_store
