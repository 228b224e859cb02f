// Markov localization: one movement and one perceptual update of a window, in a corridor with doors
// where the six sonars look up to 5 m far.
#include <cstdint>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/markov/markov_localizer.hpp"

namespace {

using namespace topogeo;

constexpr int kWidth = 400;
constexpr int kHeight = 120;

/// 40 x 12 m: a corridor 2.4 m wide between rooms, with a door every 3 m.
markov::ObstacleCells corridor() {
  std::vector<std::uint8_t> cells(std::size_t{kWidth} * kHeight, 0);
  const auto occupy = [&](int x, int y) {
    cells[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)] = 1;
  };
  for (int x = 0; x < kWidth; ++x) {
    occupy(x, 0);
    occupy(x, kHeight - 1);
    if (x % 30 < 9) continue;
    occupy(x, 47);
    occupy(x, 72);
  }
  for (int y = 0; y < kHeight; ++y) {
    occupy(0, y);
    occupy(kWidth - 1, y);
    if (y > 47 && y < 72) continue;
    for (int x = 45; x < kWidth; x += 60) occupy(x, y);
  }
  return markov::ObstacleCells{
      {.width = kWidth, .height = kHeight, .resolution_m = 0.1, .occupied = cells}};
}

/// Cells of a side of the window; the heading in degrees.
void update(benchmark::State& state, int window_cells, double heading_deg) {
  std::vector<markov::RangeSensor> sensors;
  for (const devices::SonarMount& mount : devices::macondo_sonars()) {
    sensors.push_back({mount.T_robot_sonar, mount.half_cone_rad});
  }
  const std::vector<float> ranges_m = {4.1F, 3.9F, 0.95F, 1.0F, 0.94F, 0.97F};
  markov::MarkovConfig config;
  config.window_cells = window_cells;
  markov::MarkovLocalizer localizer{config, corridor(), sensors};
  const double heading_rad = heading_deg * std::numbers::pi / 180.0;
  double ahead = 1.0;
  localizer.initialize({20.03, 6.04, heading_rad}, ranges_m);
  localizer.move({markov::MoveKind::kAdvance, 0.5});
  for (auto _ : state) {
    localizer.move({markov::MoveKind::kAdvance, 0.1 * ahead});
    benchmark::DoNotOptimize(localizer.perceive(ranges_m).weight);
    ahead = -ahead;
  }
}

BENCHMARK_CAPTURE(update, along, 21, 0.0)->Name("markov/21")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(update, askew, 21, 33.0)->Name("markov/21_askew")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(update, wide, 101, 33.0)->Name("markov/101")->Unit(benchmark::kMicrosecond);

}  // namespace
