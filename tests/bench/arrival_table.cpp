#include "arrival_table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "topogeo/support/format.hpp"

namespace topogeo::bench {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// Lower end of Wilson's interval of 95 % for a share.
double at_least(std::size_t good, std::size_t of) {
  constexpr double kZ = 1.959964;
  const auto n = static_cast<double>(of);
  const double p = static_cast<double>(good) / n;
  const double spread = kZ * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  return (p + kZ * kZ / (2.0 * n) - spread) / (1.0 + kZ * kZ / n);
}

/// Value that a share of the values do not exceed; 0 without values.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double index = std::ceil(share * static_cast<double>(values.size())) - 1.0;
  return values[static_cast<std::size_t>(std::max(index, 0.0))];
}

std::string line(const std::string& name, const std::vector<ArrivalRow>& rows,
                 const std::function<bool(const ArrivalRow&)>& counts) {
  std::size_t runs = 0;
  std::size_t arrived = 0;
  std::size_t good = 0;
  std::uint64_t collisions = 0;
  std::uint64_t run_into = 0;
  double path_m = 0.0;
  double time_s = 0.0;
  std::uint32_t detours = 0;
  std::uint32_t guard_stops = 0;
  std::size_t replans = 0;
  std::vector<double> errors_m;
  std::vector<double> errors_deg;
  for (const ArrivalRow& row : rows) {
    if (!counts(row)) continue;
    const ArrivalResult& result = row.result;
    ++runs;
    good += result.good() ? 1 : 0;
    collisions += result.collisions;
    run_into += result.run_into;
    detours += result.detours;
    guard_stops += result.guard_stops;
    replans += result.plans > 0 ? result.plans - 1 : 0;
    if (!result.arrived) continue;
    ++arrived;
    path_m += result.path_m;
    time_s += result.time_s;
    errors_m.push_back(result.error_m);
    errors_deg.push_back(kDegreesPerRadian * result.heading_error_rad);
  }
  if (runs == 0) return {};
  const auto n = static_cast<double>(runs);
  const double cm = 100.0;
  return fmt::format(
      "| {} | {} | {} | {} ({:.1f} %, >= {:.1f} %) | {:.1f} / {:.1f} / {:.1f} | {:.1f} / {:.1f} / "
      "{:.1f} | {} | {} | {:.2f} | {:.0f} | {} | {} | {} |\n",
      name, runs, arrived, good, 100.0 * static_cast<double>(good) / n,
      100.0 * at_least(good, runs), cm * quantile(errors_m, 0.5), cm * quantile(errors_m, 0.95),
      cm * quantile(errors_m, 1.0), quantile(errors_deg, 0.5), quantile(errors_deg, 0.95),
      quantile(errors_deg, 1.0), collisions, run_into, time_s > 0.0 ? path_m / time_s : 0.0,
      arrived > 0 ? time_s / static_cast<double>(arrived) : 0.0, detours, replans, guard_stops);
}

std::string failures(const std::vector<ArrivalRow>& rows) {
  std::string text;
  for (const ArrivalRow& row : rows) {
    const ArrivalResult& result = row.result;
    if (result.good()) continue;
    text += fmt::format(
        "- `--floor \"{}\" --run {}`, obstacle: {}; {:.1f} cm and {:.1f} degrees off, told pose "
        "{:.1f} cm off, {} collisions, {:.0f} s; {}\n",
        row.floor, row.run, to_string(row.obstacle), 100.0 * result.error_m,
        kDegreesPerRadian * result.heading_error_rad, 100.0 * result.pose_error_m,
        result.collisions, result.time_s, result.end);
  }
  return text.empty() ? text : "\nNot well ended:\n" + text;
}

}  // namespace

std::string arrival_table(const std::vector<ArrivalRow>& rows) {
  std::string text =
      "| floor | runs | arrived | within 10 cm and 5 degrees, no collision | position, cm: median "
      "/ "
      "95 % / worst | heading, degrees | collisions | run into by things | m/s | s | detours | new "
      "routes | guard stops |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::vector<std::string> floors;
  for (const ArrivalRow& row : rows) {
    if (std::find(floors.begin(), floors.end(), row.floor) == floors.end()) {
      floors.push_back(row.floor);
    }
  }
  for (const std::string& floor : floors) {
    text += line(floor, rows, [&](const ArrivalRow& row) { return row.floor == floor; });
  }
  const auto with = [](const ArrivalRow& row) { return row.obstacle != ObstacleKind::kNone; };
  text += line("without obstacle", rows, [&](const ArrivalRow& row) { return !with(row); });
  text += line("with obstacle", rows, with);
  text += line("all", rows, [](const ArrivalRow&) { return true; });
  return text + failures(rows);
}

}  // namespace topogeo::bench
