// Whether detected rooms are those that people draw. Prints a table of their overlap.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/hybrid_map_config.hpp"
#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/world/world.hpp"

#include "../planning/floors.hpp"

namespace topogeo::pipeline {
namespace {

using planning::DrawnZone;
using planning::FreeSpace;
using planning::ZoneId;
using planning::ZoneMap;

constexpr double kGoodOverlap = 0.95;

/// Intersection over union of the cells of each drawn room and of the detected room with the
/// largest overlap; every detected room counts once.
std::map<std::string, double> overlaps(const FreeSpace& space, const ZoneMap& found,
                                       const std::vector<DrawnZone>& drawn) {
  planning::ZoneConfig config;
  config.min_area_m2 = 0.0;
  const ZoneMap truth = planning::drawn_zones(space, drawn, config);
  std::map<std::pair<ZoneId, ZoneId>, double> common;
  for (std::size_t i = 0; i < truth.zone_of_cell.size(); ++i) {
    if (space.passable(i)) common[{truth.zone_of_cell[i], found.zone_of_cell[i]}] += 1.0;
  }
  std::map<std::string, double> best;
  for (const planning::Zone& room : truth.zones) best[room.name] = 0.0;
  for (const auto& [pair, cells] : common) {
    const auto drawn_cells = static_cast<double>(truth.zones[pair.first].cells);
    const auto found_cells = static_cast<double>(found.zones[pair.second].cells);
    double& overlap = best[truth.zones[pair.first].name];
    overlap = std::max(overlap, cells / (drawn_cells + found_cells - cells));
  }
  return best;
}

/// A row of the table for one or several floors.
class OverlapRow {
 public:
  explicit OverlapRow(std::string name) : name_(std::move(name)) {}
  OverlapRow(const OverlapRow&) = delete;
  OverlapRow& operator=(const OverlapRow&) = delete;
  ~OverlapRow() {
    std::printf("| %s | %zu | %zu | %.1f %% | %.1f %% (%s) |\n", name_.c_str(), drawn_, found_,
                100.0 * sum_ / static_cast<double>(std::max<std::size_t>(1, drawn_)),
                100.0 * worst_, worst_room_.c_str());
  }

  /// A floor on which every drawn room is detected, and no other.
  void expect_rooms(const FreeSpace& space, const std::vector<DrawnZone>& drawn) {
    const ZoneMap found = planning::zones_of_rooms(space);
    for (const auto& [name, overlap] : overlaps(space, found, drawn)) {
      EXPECT_GE(overlap, kGoodOverlap) << "'" << name << "'";
      sum_ += overlap;
      if (overlap >= worst_) continue;
      worst_ = overlap;
      worst_room_ = name;
    }
    EXPECT_EQ(found.zones.size(), drawn.size());
    drawn_ += drawn.size();
    found_ += found.zones.size();
  }

 private:
  std::string name_;
  std::size_t drawn_ = 0;
  std::size_t found_ = 0;
  double sum_ = 0.0;
  double worst_ = 1.0;
  std::string worst_room_ = "all alike";
};

/// A world file, rotated, as a floor with its rooms.
void expect_rooms_of_world(const std::string& name, double turned_rad) {
  char title[80];
  std::snprintf(title, sizeof title, "%s, turned by %.1f rad", name.c_str(), turned_rad);
  SCOPED_TRACE(title);
  const world::World world =
      world::load_world(std::filesystem::path(TOPOGEO_SHARE) / "worlds" / (name + ".world.yaml"));
  const geometry::Pose2 turn{0.0, 0.0, turned_rad};
  planning::Drawing drawing = drawing_of(world);
  for (auto& line : drawing.lines) line = {turn * line.a_m, turn * line.b_m};
  for (auto& disc : drawing.discs) disc.center_m = turn * disc.center_m;
  for (auto& inside_m : drawing.inside_m) inside_m = turn * inside_m;
  std::vector<DrawnZone> rooms;
  for (const world::Room& room : world.rooms) {
    DrawnZone& zone = rooms.emplace_back(DrawnZone{room.name, room.polygon_m});
    for (auto& corner_m : zone.polygon_m) corner_m = turn * corner_m;
  }
  ASSERT_FALSE(rooms.empty());
  const HybridMapConfig config;
  OverlapRow(title).expect_rooms(FreeSpace(planning::grid_of(drawing, 0.1), config.inflation),
                                 rooms);
}

TEST(RoomsFound, AreThoseOfTheOfficeFloor) {
  for (const double turned_rad : {0.0, 0.3, 0.5, 0.8, 1.2, 2.0, 2.9})
    expect_rooms_of_world("floor", turned_rad);
}

// Free-standing racks do not turn the aisles between them into rooms.
TEST(RoomsFound, AreThoseOfTheWarehouse) {
  for (const double turned_rad : {0.0, 0.3, 0.5, 0.8, 1.2, 2.0, 2.9})
    expect_rooms_of_world("hall", turned_rad);
}

// Furnished rooms with known doors.
TEST(RoomsFound, AreThoseOfRandomFloors) {
  OverlapRow row("20 random floors, rooms of 5 x 4 m");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const planning::BlockFloor floor = planning::block_floor({}, seed);
    row.expect_rooms(FreeSpace(floor.grid, HybridMapConfig{}.inflation), floor.rooms);
  }
}

TEST(RoomsFound, AreThoseOfRandomFloorsOfOtherSizes) {
  for (const planning::BlockPlan& plan :
       {planning::BlockPlan{3, 4, 70, 60, 12, 4}, planning::BlockPlan{6, 2, 36, 44, 9, 1},
        planning::BlockPlan{2, 2, 120, 90, 16, 8}}) {
    char title[80];
    std::snprintf(title, sizeof title, "10 random floors, rooms of %.1f x %.1f m",
                  0.1 * plan.room_width, 0.1 * plan.room_height);
    OverlapRow row(title);
    for (std::uint64_t seed = 100; seed < 110; ++seed) {
      SCOPED_TRACE(std::to_string(plan.room_width) + ", seed " + std::to_string(seed));
      const planning::BlockFloor floor = planning::block_floor(plan, seed);
      row.expect_rooms(FreeSpace(floor.grid, HybridMapConfig{}.inflation), floor.rooms);
    }
  }
}

}  // namespace
}  // namespace topogeo::pipeline
