#include "sonar_table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "topogeo/support/format.hpp"

namespace topogeo::bench {
namespace {

constexpr double kToDegrees = 180.0 / std::numbers::pi;

/// Value that a share of the values do not exceed; 0 without values.
double sonar_quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double index = std::ceil(share * static_cast<double>(values.size())) - 1.0;
  return values[static_cast<std::size_t>(std::max(index, 0.0))];
}

std::string sonar_line(const std::string& name, const std::vector<SonarRow>& rows,
                       const std::function<bool(const SonarRow&)>& counts) {
  std::size_t runs = 0;
  std::size_t arrived = 0;
  std::size_t good = 0;
  std::uint64_t collisions = 0;
  std::uint32_t guard_stops = 0;
  double path_m = 0.0;
  double time_s = 0.0;
  std::vector<double> errors_m;
  std::vector<double> errors_deg;
  std::vector<double> poses_m;
  for (const SonarRow& row : rows) {
    if (!counts(row)) continue;
    const SonarResult& result = row.result;
    ++runs;
    good += result.good() ? 1 : 0;
    collisions += result.collisions;
    guard_stops += result.guard_stops;
    poses_m.push_back(result.largest_pose_m);
    if (!result.arrived) continue;
    ++arrived;
    path_m += result.path_m;
    time_s += result.time_s;
    errors_m.push_back(result.error_m);
    errors_deg.push_back(kToDegrees * result.heading_error_rad);
  }
  if (runs == 0) return {};
  const double cm = 100.0;
  return fmt::format(
      "| {} | {} | {} | {} ({:.1f} %) | {:.1f} / {:.1f} / {:.1f} | {:.1f} / {:.1f} | {:.1f} / "
      "{:.1f} | {} | {:.2f} | {:.0f} | {} |\n",
      name, runs, arrived, good, 100.0 * static_cast<double>(good) / static_cast<double>(runs),
      cm * sonar_quantile(errors_m, 0.5), cm * sonar_quantile(errors_m, 0.95),
      cm * sonar_quantile(errors_m, 1.0), sonar_quantile(errors_deg, 0.5),
      sonar_quantile(errors_deg, 0.95), cm * sonar_quantile(poses_m, 0.5),
      cm * sonar_quantile(poses_m, 0.95), collisions, time_s > 0.0 ? path_m / time_s : 0.0,
      arrived > 0 ? time_s / static_cast<double>(arrived) : 0.0, guard_stops);
}

std::string sonar_failures(const std::vector<SonarRow>& rows) {
  std::string text;
  for (const SonarRow& row : rows) {
    const SonarResult& result = row.result;
    if (result.good()) continue;
    text += fmt::format(
        "- `--floor \"{}\" --run {}`{}: {:.1f} cm and {:.1f} degrees off, reported pose {:.1f} cm "
        "off, {} collisions, {:.0f} s; {}\n",
        row.floor, row.run, row.obstacle ? ", a box" : "", 100.0 * result.error_m,
        kToDegrees * result.heading_error_rad, 100.0 * result.pose_error_m, result.collisions,
        result.time_s, result.end);
  }
  return text.empty() ? text : "\nNot well ended:\n" + text;
}

}  // namespace

std::string sonar_table(const std::vector<SonarRow>& rows) {
  std::string text =
      "| floor | drives | arrived | within a cell, no collision | position, cm: median / 95 % / "
      "worst | heading, degrees: median / 95 % | largest error of the pose, cm: median / 95 % | "
      "collisions | m/s | s | guard stops |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::vector<std::string> floors;
  for (const SonarRow& row : rows) {
    if (std::find(floors.begin(), floors.end(), row.floor) == floors.end()) {
      floors.push_back(row.floor);
    }
  }
  for (const std::string& floor : floors) {
    text += sonar_line(floor, rows, [&](const SonarRow& row) { return row.floor == floor; });
  }
  const bool any =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.obstacle; });
  if (any) text += sonar_line("with a box", rows, [](const SonarRow& row) { return row.obstacle; });
  text += sonar_line("all", rows, [](const SonarRow&) { return true; });
  return text + sonar_failures(rows);
}

}  // namespace topogeo::bench
