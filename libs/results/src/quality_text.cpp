// The quality of a map for people.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "topogeo/results/map_quality.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::results {
namespace {

using storage::OdometryStretchEntry;
using storage::PathDisagreementEntry;
using storage::Report;

double degrees(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

std::string stretch_line(const OdometryStretchEntry& s) {
  return fmt::format(
      "  stops {} to {} at x {:.1f} m, y {:.1f} m: {:.1f} m long, may be off {:.2f} m and {:.0f} "
      "deg\n",
      s.first_stop, s.last_stop, s.x_m, s.y_m, s.length_m, s.off_m, degrees(s.off_rad));
}

std::string stretch_lines(const std::vector<OdometryStretchEntry>& all) {
  std::vector<OdometryStretchEntry> open;
  std::uint64_t open_steps = 0;
  std::uint64_t held_steps = 0;
  for (const OdometryStretchEntry& stretch : all) {
    (stretch.held_by_loop ? held_steps : open_steps) += stretch.last_stop - stretch.first_stop;
    if (!stretch.held_by_loop) open.push_back(stretch);
  }
  if (all.empty()) return {};
  std::string text = fmt::format("steps without a match: {}", open_steps + held_steps);
  if (held_steps > 0) text += fmt::format(", {} of them held by loops", held_steps);
  text += '\n';
  constexpr std::size_t kMostLines = 3;
  std::ranges::stable_sort(open, std::greater<>{}, &OdometryStretchEntry::off_m);
  for (std::size_t i = 0; i < std::min(open.size(), kMostLines); ++i) text += stretch_line(open[i]);
  if (open.size() > kMostLines) {
    text += fmt::format("  and {} more in report.json\n", open.size() - kMostLines);
  }
  return text;
}

/// A part whose odometry does not count.
bool is_left_out(const PathDisagreementEntry& d) {
  return d.kind == "wheels" || d.kind == "carried";
}

std::string left_out_line(const PathDisagreementEntry& d) {
  if (d.kind == "carried") {
    return fmt::format(
        "odometry: stop {}: the scans show another place while the wheels stand: the robot was "
        "carried, and the scans have found it again\n",
        d.last_stop);
  }
  const char* cause =
      d.corrected_m > d.odometry_m ? "the robot was carried or pushed" : "the wheels spun";
  return fmt::format(
      "odometry: stops {} to {}: {:.2f} m by the wheels, {:.2f} m by the scans, {:.0f} deg between "
      "them: {}, and the scans count\n",
      d.first_stop, d.last_stop, d.odometry_m, d.corrected_m, degrees(std::fabs(d.turn_rad)),
      cause);
}

std::string disagreement_line(const PathDisagreementEntry& d) {
  const std::string place = fmt::format("stops {} to {}", d.first_stop, d.last_stop);
  if (d.kind == "turn") {
    return fmt::format("warning: {}: the map turns by {:.0f} deg more than odometry\n", place,
                       degrees(d.turn_rad));
  }
  return fmt::format("warning: {}: the robot {} {:.2f} m in the map, {:.2f} m by odometry\n", place,
                     d.kind == "jump" ? "jumps" : "drives", d.corrected_m, d.odometry_m);
}

std::string disagreement_lines(const std::vector<PathDisagreementEntry>& all) {
  constexpr std::size_t kMostLines = 3;  // of each sort
  std::string text;
  std::size_t left_out = 0;
  std::size_t warnings = 0;
  for (const PathDisagreementEntry& d : all) {
    if (is_left_out(d)) {
      if (++left_out <= kMostLines) text += left_out_line(d);
    } else if (++warnings <= kMostLines) {
      text += disagreement_line(d);
    }
  }
  if (left_out > kMostLines) {
    text += fmt::format("odometry: {} more such parts in report.json\n", left_out - kMostLines);
  }
  if (warnings > kMostLines) {
    text += fmt::format("warning: {} more such parts in report.json\n", warnings - kMostLines);
  }
  return text;
}

}  // namespace

std::string quality_text(const Report& report) {
  const storage::QualityEntry& quality = report.quality;
  if (quality.grade.empty()) return {};
  std::string text = "quality: " + quality.grade;
  for (std::size_t i = 0; i < quality.reasons.size(); ++i) {
    text += (i == 0 ? ": " : "; ") + quality.reasons[i];
  }
  text += '\n';
  if (!quality.advice.empty()) text += "try: " + quality.advice + '\n';
  text += stretch_lines(quality.odometry_stretches);
  return text + disagreement_lines(quality.path_disagreements);
}

}  // namespace topogeo::results
