#include "topogeo/results/map_quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/pipeline/odometry_links.hpp"
#include "topogeo/pipeline/path_disagreement.hpp"
#include "topogeo/support/format.hpp"

#include "judgement.hpp"

namespace topogeo::results {
namespace {

using pipeline::PathDisagreement;
using storage::OdometryStretchEntry;
using storage::PathDisagreementEntry;
using storage::Report;

// Thresholds, each in the middle of a gap between right and wrong maps.
constexpr double kFewestRecentMatches = 1.55;  // at each stop
constexpr double kUsualRecentMatches = 3.0;    // compared at each stop by default
constexpr double kOdometryDisagrees = 0.15;    // typical displacement per length
constexpr double kOdometryContradicts = 0.33;  // the same, whatever the matches are
constexpr double kGoodAcceptedShare = 0.7;
constexpr double kMostContradicted = 0.3;  // of the steps
constexpr std::size_t kPartsOfScale = 5;   // fewer are alike by chance
constexpr double kSameScale = 1.15;
constexpr double kOtherScale = 1.35;
constexpr double kOtherLengths = 1.045;  // of the path, all along
constexpr double kFeetOfMetre = 1.0 / 0.3048;
constexpr double kNearUnit = 1.05;
constexpr double kMostSkipped = 0.5;
constexpr double kMostUnmapped = 0.05;  // of the stops (own)
constexpr double kLongDrive_m = 10.0;
constexpr std::uint64_t kStopsOfLongDrive = 10;
constexpr std::uint32_t kStopsOfEnd = 3;  // an open step there moves hardly anything
constexpr double kLongStep_m = 0.4;

constexpr const char* kMoreStops = "more stops: stop: {distance_m: 0.5} in a file for --config";
constexpr const char* kCalibrateOdometry = "topogeo calibrate-odometry ";
constexpr const char* kLaserOdometry =
    "odometry from the scans: odometry: {source: laser} in a file for --config";
constexpr const char* kInMetres =
    "the ranges in metres: scan: {range_scale: 0.3048} in a file for --config";
constexpr const char* kOtherRecording =
    "a recording with odometry of wheels, or of a laser that sees farther";

struct Facts {
  std::uint64_t steps = 0;
  double path_m = 0.0;       // by odometry that counts, from stop to stop
  double corrected_m = 0.0;  // in the map
  double fewest_recent_matches = kFewestRecentMatches;
  double recent_matches = 0.0;  // per step
  double accepted_share = 0.0;
  double skipped_share = 0.0;
  std::uint64_t unmapped_stops = 0;
  double typical_share = 0.0;
  std::uint64_t open_steps = 0;  // by odometry alone, and held by no loop
  double open_m = 0.0;
  bool splits = false;  // an open step with stops on both sides
  bool jumps = false;
  bool other_length = false;
  double contradicted_share = 0.0;      // of the steps: the scans contradict their odometry
  double without_odometry_share = 0.0;  // of the scans
  double scale = 1.0;                   // of the scans over the odometry, if it is another one
  double length_scale = 1.0;            // of the path over the odometry, all along
  bool from_scans = false;              // the odometry is made of the scans

  /// A shorter drive says little.
  [[nodiscard]] bool is_long() const {
    return steps >= kStopsOfLongDrive && std::max(path_m, corrected_m) >= kLongDrive_m;
  }
  [[nodiscard]] bool ranges_in_feet() const {
    return scale > kFeetOfMetre / kNearUnit && scale < kFeetOfMetre * kNearUnit;
  }
  [[nodiscard]] bool other_lengths() const {
    return length_scale > kOtherLengths || length_scale < 1.0 / kOtherLengths;
  }
  /// Whether another odometry is wanted.
  [[nodiscard]] bool odometry_useless() const {
    return scale != 1.0 || contradicted_share > kMostContradicted ||
           without_odometry_share > kMostSkipped;
  }
};

double accepted_share(const Report& report) {
  return static_cast<double>(report.matches_accepted) /
         static_cast<double>(std::max<std::uint64_t>(report.matches_tried, 1));
}

/// The scale of the scans over the odometry, if it is the same, and far from 1, in all parts that
/// they contradict; else 1. A wheel that spins has another scale each time.
double other_scale(const std::vector<PathDisagreementEntry>& disagreements) {
  std::vector<double> scales;
  for (const PathDisagreementEntry& d : disagreements) {
    if (d.kind == "wheels" && d.odometry_m > 0.0) scales.push_back(d.corrected_m / d.odometry_m);
  }
  if (scales.size() < kPartsOfScale) return 1.0;
  std::ranges::sort(scales);
  const double middle = scales[scales.size() / 2];
  const bool alike = scales.front() > middle / kSameScale && scales.back() < middle * kSameScale;
  const bool other = middle > kOtherScale || middle < 1.0 / kOtherScale;
  return alike && other ? middle : 1.0;
}

Facts facts_of(const Report& report, const storage::MapDocument& document) {
  using Kind = storage::MapEdge::Kind;
  Facts facts;
  std::uint64_t recent = 0;
  std::uint64_t seeing = 0;  // stops after the first one that can match at all
  for (const storage::MapEdge& edge : document.edges) {
    if (edge.kind == Kind::kSequential) ++recent;
  }
  const auto& maps = document.local_maps;
  const auto& stops = document.trajectory.stops;
  for (std::size_t i = 1; i < maps.size(); ++i) {
    if (maps[i].starts_drive) continue;
    ++facts.steps;
    if (!maps[i].points.empty()) ++seeing;
    if (i < stops.size()) {
      facts.corrected_m +=
          geometry::between(stops[i - 1].T_map_robot, stops[i].T_map_robot).position_m().norm();
    }
    if (!topomap::has_odometry_between(maps[i - 1], maps[i])) continue;
    facts.path_m += std::sqrt(geometry::between(maps[i - 1].T_odom_robot, maps[i].T_odom_robot)
                                  .position_m()
                                  .squaredNorm());
  }
  const auto share = [](double part, double whole) { return whole > 0.0 ? part / whole : 0.0; };
  facts.recent_matches = share(static_cast<double>(recent), static_cast<double>(seeing));
  facts.accepted_share = accepted_share(report);
  facts.from_scans = report.laser_odometry.has_value();
  std::uint64_t skipped = 0;
  for (const auto& [reason, count] : report.skipped_lines) skipped += count;
  facts.skipped_share =
      share(static_cast<double>(skipped), static_cast<double>(skipped + report.scans));
  for (const OdometryStretchEntry& stretch : report.quality.odometry_stretches) {
    if (stretch.held_by_loop) continue;
    facts.open_steps += stretch.last_stop - stretch.first_stop;
    facts.open_m += stretch.length_m;
    if (stretch.last_stop >= kStopsOfEnd && stretch.first_stop + kStopsOfEnd < maps.size()) {
      facts.splits = true;
    }
  }
  std::uint64_t contradicted = 0;
  for (const PathDisagreementEntry& d : report.quality.path_disagreements) {
    if (d.kind == "jump") facts.jumps = true;
    if (d.kind == "length") facts.other_length = true;
    if (d.kind == "wheels") contradicted += d.last_stop - d.first_stop;
  }
  facts.scale = other_scale(report.quality.path_disagreements);
  facts.contradicted_share =
      share(static_cast<double>(contradicted), static_cast<double>(facts.steps));
  return facts;
}

void judge_odometry(const Facts& facts, Judgement& judgement) {
  const std::string apart = fmt::format(
      "scans and odometry are typically {:.2f} m apart after a metre", facts.typical_share);
  if (facts.typical_share > kOdometryContradicts ||
      (facts.typical_share > kOdometryDisagrees && facts.accepted_share < kGoodAcceptedShare)) {
    judgement.poor(apart);
  } else if (facts.typical_share > kOdometryDisagrees) {
    judgement.fair(apart);
  }
  if (facts.contradicted_share > kMostContradicted) {
    judgement.poor(fmt::format("the scans contradict the odometry in {:.0f} % of the steps",
                               100.0 * facts.contradicted_share));
  }
  if (facts.scale != 1.0) {
    judgement.poor(fmt::format("the robot drives {:.2f} m by the scans for each metre of odometry",
                               facts.scale));
  }
  if (facts.ranges_in_feet()) judgement.poor("the ranges of the laser are probably in feet");
  if (facts.jumps) judgement.poor("the path jumps where odometry does not");
  if (facts.other_length) judgement.fair("the path is much longer or shorter than by odometry");
}

/// After all other reasons.
void judge_scale(const Facts& facts, Judgement& judgement) {
  if (facts.scale != 1.0 || !facts.other_lengths()) return;
  const bool longer = facts.length_scale > 1.0;
  judgement.of_unknown_scale(fmt::format(
      "the path is {:.1f} % {} by the scans than by the odometry all along: either the ranges of "
      "the laser are too {} or the odometry is too {}, and a log cannot tell which",
      100.0 * std::fabs(facts.length_scale - 1.0), longer ? "longer" : "shorter",
      longer ? "long" : "short", longer ? "short" : "long"));
}

Judgement judge(const Report& report, const Facts& facts) {
  Judgement judgement;
  if (facts.open_steps > 0) {
    std::string reason = fmt::format("{} of {} steps ({:.1f} m of {:.1f} m) rest on odometry alone",
                                     facts.open_steps, facts.steps, facts.open_m, facts.path_m);
    facts.splits ? judgement.poor(std::move(reason)) : judgement.fair(std::move(reason));
  }
  if (facts.steps >= kStopsOfLongDrive && facts.recent_matches < facts.fewest_recent_matches) {
    judgement.poor(
        fmt::format("a stop matches only {:.1f} recent ones ({:.2f} or more in right maps)",
                    facts.recent_matches, facts.fewest_recent_matches));
  }
  judge_odometry(facts, judgement);
  if (facts.unmapped_stops > 0) {
    const std::uint64_t stops = report.stops + facts.unmapped_stops;
    std::string reason = fmt::format(
        "{} of {} stops are not in the map, because the robot was not found again in it",
        facts.unmapped_stops, stops);
    const double share = static_cast<double>(facts.unmapped_stops) / static_cast<double>(stops);
    share > kMostUnmapped ? judgement.poor(std::move(reason)) : judgement.fair(std::move(reason));
  }
  if (facts.skipped_share > kMostSkipped) {
    judgement.incomplete(
        fmt::format("{:.0f} % of the scans were skipped", 100.0 * facts.skipped_share));
  }
  if (report.matches_accepted == 0 && facts.is_long()) {
    judgement.useless(
        fmt::format("no match was accepted over {:.1f} m, so the map shows odometry "
                    "alone",
                    facts.path_m));
  }
  judge_scale(facts, judgement);
  return judgement;
}

std::string range_scale(const Facts& facts) {
  return fmt::format(
      "scan: {{range_scale: {:.3g}}} in a file for --config if the odometry is right, 1 in its "
      "place if the ranges are",
      1.0 / facts.length_scale);
}

/// The one thing that helps most. A calibration that the program makes by itself belongs before
/// this advice.
std::string advice(const Facts& facts, const std::string& grade, const QualityInputs& inputs) {
  if (grade == kGood) return {};
  if (grade == kUseless) {
    return "topogeo dvl --log " + inputs.log +
           " --scan 0 --out scan.png  # shows what the laser sees";
  }
  if (facts.ranges_in_feet()) return kInMetres;
  if (grade == kFair && facts.other_lengths()) return range_scale(facts);
  const bool slips = grade == kFair && facts.other_length && !facts.from_scans;
  if ((facts.odometry_useless() || slips) && !inputs.tried.contains(Remedy::kLaserOdometry)) {
    return kLaserOdometry;
  }
  if (facts.skipped_share > kMostSkipped) return "topogeo check-log " + inputs.log;
  const bool disagrees = facts.typical_share > kOdometryDisagrees;
  if (disagrees && (!inputs.laser_known || facts.typical_share > kOdometryContradicts)) {
    return "topogeo calibrate-laser " + inputs.log + " --out laser.yaml";
  }
  const double step_m = facts.steps > 0 ? facts.path_m / static_cast<double>(facts.steps) : 0.0;
  const bool few_matches = facts.open_steps > 0 || facts.unmapped_stops > 0 ||
                           facts.recent_matches < facts.fewest_recent_matches;
  if (!disagrees && few_matches && step_m >= kLongStep_m &&
      !inputs.tried.contains(Remedy::kMoreStops)) {
    return kMoreStops;
  }
  if (facts.from_scans) return kOtherRecording;
  if (!inputs.tried.contains(Remedy::kOdometryNoise)) {
    return kCalibrateOdometry + inputs.log + " --out odometry.yaml";
  }
  if (!inputs.tried.contains(Remedy::kLaserOdometry)) return kLaserOdometry;
  if (facts.other_lengths()) return range_scale(facts);
  return "topogeo check-log " + inputs.log;
}

/// Path that rests on odometry alone and that no loop holds, m.
double open_m(const Report& report) {
  double sum_m = 0.0;
  for (const OdometryStretchEntry& stretch : report.quality.odometry_stretches) {
    if (!stretch.held_by_loop) sum_m += stretch.length_m;
  }
  return sum_m;
}

/// 0 for the best grade.
std::ptrdiff_t rank_of(const std::string& grade) {
  constexpr std::array<std::string_view, 4> kGrades{kGood, kFair, kPoor, kUseless};
  return std::ranges::find(kGrades, grade) - kGrades.begin();
}

const char* name_of(PathDisagreement::Kind kind) {
  switch (kind) {
    case PathDisagreement::Kind::kLength:
      return "length";
    case PathDisagreement::Kind::kTurn:
      return "turn";
    case PathDisagreement::Kind::kJump:
      return "jump";
    case PathDisagreement::Kind::kWheels:
      return "wheels";
    case PathDisagreement::Kind::kCarried:
      return "carried";
  }
  return "unknown";
}

}  // namespace

void add_quality(Report& report, const storage::MapDocument& document,
                 const QualityInputs& inputs) {
  report.quality = {};
  if (document.edges.empty() && document.local_maps.size() > 1) return;
  const auto& stops = document.trajectory.stops;
  for (const pipeline::OdometryStretch& s : pipeline::odometry_stretches(document)) {
    const geometry::Pose2 start =
        s.first_id < stops.size() ? stops[s.first_id].T_map_robot : geometry::Pose2{};
    report.quality.odometry_stretches.push_back({s.first_id, s.last_id, start.x_m, start.y_m,
                                                 s.length_m, s.off_m, s.off_rad, s.held_by_loop});
  }
  const pipeline::PathComparison comparison = pipeline::compare_with_odometry(document);
  for (const PathDisagreement& d : comparison.disagreements) {
    report.quality.path_disagreements.push_back(
        {name_of(d.kind), d.first_id, d.last_id, d.odometry_m, d.corrected_m, d.turn_rad});
  }
  Facts facts = facts_of(report, document);
  facts.typical_share = comparison.typical_share;
  if (!inputs.range_scale_known && !facts.from_scans) facts.length_scale = comparison.scale;
  facts.unmapped_stops = inputs.unmapped_stops;
  facts.without_odometry_share =
      static_cast<double>(inputs.scans_without_odometry) /
      static_cast<double>(std::max<std::uint64_t>(report.scans + inputs.scans_without_odometry, 1));
  facts.fewest_recent_matches = kFewestRecentMatches / kUsualRecentMatches * inputs.recent_matches;
  const Judgement judgement = judge(report, facts);
  report.quality.grade = judgement.grade();
  report.quality.reasons = judgement.reasons();
  report.quality.unreliable =
      judgement.unreliable() && (facts.is_long() || facts.unmapped_stops >= kStopsOfLongDrive);
  report.quality.advice = advice(facts, judgement.grade(), inputs);
}

std::optional<Remedy> advised_remedy(const Report& report) {
  const std::string& advice = report.quality.advice;
  // Wheels that slip bend a map whose matches are good.
  const bool slips = report.quality.grade == kFair && advice == kLaserOdometry;
  if (report.quality.grade != kPoor && !slips) return std::nullopt;
  if (advice == kMoreStops) return Remedy::kMoreStops;
  if (advice.starts_with(kCalibrateOdometry)) return Remedy::kOdometryNoise;
  if (advice == kLaserOdometry) return Remedy::kLaserOdometry;
  return std::nullopt;
}

bool is_better(const Report& report, const Report& other) {
  constexpr double kMore = 1.1;
  const auto scans = static_cast<double>(report.scans);
  const auto other_scans = static_cast<double>(other.scans);
  if (scans > kMore * other_scans) return true;
  if (other_scans > kMore * scans) return false;
  const std::ptrdiff_t rank = rank_of(report.quality.grade);
  const std::ptrdiff_t other_rank = rank_of(other.quality.grade);
  if (rank != other_rank) return rank < other_rank;
  constexpr double kLess = 0.5;
  if (open_m(report) < kLess * open_m(other)) return true;
  if (open_m(other) < kLess * open_m(report)) return false;
  // Odometry from the scans agrees with them by itself.
  if (report.laser_odometry.has_value() != other.laser_odometry.has_value()) return false;
  constexpr double kMoreAccepted = 1.25;
  return accepted_share(report) > kMoreAccepted * accepted_share(other);
}

bool is_unreliable(const Report& report) {
  return report.quality.unreliable;
}

}  // namespace topogeo::results
