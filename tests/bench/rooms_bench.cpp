// Rooms of a floor of 200 x 200 m, 2,000 x 2,000 cells with 200 rooms: finding them between the
// walls, and recognizing them in the next map.
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/planning/room_numbers.hpp"
#include "topogeo/planning/zones.hpp"

#include "planning/floors.hpp"

namespace {

using namespace topogeo;
using namespace topogeo::planning;

const FreeSpace& floor_of_rooms() {
  constexpr std::uint64_t kSeed = 2000;
  static const FreeSpace space(block_floor({20, 10, 100, 200, 10, 6}, kSeed).grid);
  return space;
}

// Number of stops of a drive through all rooms.
std::vector<topomap::StopPose> stops_every_metres(double apart_m) {
  const GridFrame& frame = floor_of_rooms().frame();
  std::vector<topomap::StopPose> stops;
  for (double x_m = apart_m; x_m < frame.columns * frame.resolution_m; x_m += apart_m) {
    for (double y_m = apart_m; y_m < frame.rows * frame.resolution_m; y_m += apart_m) {
      topomap::StopPose& stop = stops.emplace_back();
      stop.stop = {1, static_cast<std::uint32_t>(stops.size())};
      stop.T_map_robot = {x_m, y_m, 0.0};
    }
  }
  return stops;
}

void rooms_find(benchmark::State& state) {
  std::size_t rooms = 0;
  for (auto _ : state) {
    const ZoneMap zones = zones_of_rooms(floor_of_rooms());
    rooms = zones.zones.size();
    benchmark::DoNotOptimize(zones.zone_of_cell.data());
  }
  state.counters["rooms"] = static_cast<double>(rooms);
}
BENCHMARK(rooms_find)->Name("rooms/find_2000")->Unit(benchmark::kMillisecond);

void rooms_number(benchmark::State& state) {
  static const ZoneMap found = zones_of_rooms(floor_of_rooms());
  constexpr double kStops_m = 5.0;
  const std::vector<topomap::StopPose> stops = stops_every_metres(kStops_m);
  RoomNumbers numbers;
  std::vector<Place> places;
  ZoneMap first = found;
  numbers.assign(floor_of_rooms(), stops, first, places);
  for (auto _ : state) {
    ZoneMap again = found;
    numbers.assign(floor_of_rooms(), stops, again, places);
    if (again.zones.back().room != first.zones.back().room) {
      state.SkipWithError("a room has got another number");
      break;
    }
  }
  state.counters["stops"] = static_cast<double>(stops.size());
}
BENCHMARK(rooms_number)->Name("rooms/number_2000")->Unit(benchmark::kMillisecond);

}  // namespace
