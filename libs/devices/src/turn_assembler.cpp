#include "topogeo/devices/turn_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/echo_grid.hpp"

namespace topogeo::devices {
namespace {

constexpr double kFullTurn_rad = 2.0 * std::numbers::pi;
/// Two beams that are further apart have lost beams between them: the slowest lasers of this kind
/// measure every 1.8 degrees.
constexpr double kLargestStep_rad = 4.0 * std::numbers::pi / 180.0;
/// Samples of interleaved lasers may step back by this much.
constexpr double kStepBack_rad = 10.0 * std::numbers::pi / 180.0;
/// After a larger gap nobody knows whether a whole turn was lost.
constexpr double kLargestGap_rad = 0.5 * std::numbers::pi;
/// Share of a turn that a scan needs.
constexpr double kLeastCovered = 0.9;

double positive_angle(double angle_rad) {
  const double rest_rad = std::fmod(angle_rad, kFullTurn_rad);
  return rest_rad < 0.0 ? rest_rad + kFullTurn_rad : rest_rad;
}

}  // namespace

TurnAssembler::TurnAssembler(const TurningLaserSettings& settings, std::size_t beams,
                             double range_max_m, bool clockwise)
    : settings_(settings),
      beams_(settings.beams > 0 ? settings.beams : beams),
      range_max_m_(settings.largest_range_m(range_max_m)),
      angle_step_rad_(kFullTurn_rad / static_cast<double>(beams_)),
      mirrored_(clockwise != settings.upside_down) {}

void TurnAssembler::restart() {
  turn_.clear();
  covered_rad_ = 0.0;
}

void TurnAssembler::add(const TurningBeam& beam) {
  const double since_cut_rad = positive_angle(beam.turned_rad + std::numbers::pi);
  if (turn_.empty()) return begin_turn(beam, since_cut_rad);
  const double last_rad = front_rad_;
  double step_rad = since_cut_rad - last_rad;
  if (step_rad < -std::numbers::pi) step_rad += kFullTurn_rad;
  if (step_rad > std::numbers::pi) step_rad -= kFullTurn_rad;  // back over the cut
  if (step_rad < -kStepBack_rad || step_rad > kLargestGap_rad) {
    ++incomplete_;
    return begin_turn(beam, since_cut_rad);
  }
  const bool over_cut = last_rad + step_rad >= kFullTurn_rad;
  if (over_cut) {
    if (step_rad <= kLargestStep_rad) covered_rad_ += kFullTurn_rad - last_rad;
    finish_turn();
    return begin_turn(beam, since_cut_rad);
  }
  if (step_rad > 0.0) {
    if (step_rad <= kLargestStep_rad) covered_rad_ += step_rad;
    front_rad_ = since_cut_rad;
  }
  const bool back_over_cut = last_rad + step_rad < 0.0;
  turn_.push_back(
      {back_over_cut ? 0.0 : since_cut_rad, beam.range_m, beam.time_ns, beam.aside_rad});
}

void TurnAssembler::begin_turn(const TurningBeam& beam, double since_cut_rad) {
  turn_.clear();
  covered_rad_ = since_cut_rad <= kLargestStep_rad ? since_cut_rad : 0.0;
  front_rad_ = since_cut_rad;
  turn_.push_back({since_cut_rad, beam.range_m, beam.time_ns, beam.aside_rad});
}

std::optional<LaserScan> TurnAssembler::take_scan() {
  return std::exchange(scan_, std::nullopt);
}

void TurnAssembler::finish_turn() {
  if (covered_rad_ < kLeastCovered * kFullTurn_rad) {
    ++incomplete_;
    return;
  }
  scan_ = scan_of_turn();
  if (has_stamp_) scan_->stamp_ns = std::max(scan_->stamp_ns, last_stamp_ns_ + 1);
  last_stamp_ns_ = scan_->stamp_ns;
  has_stamp_ = true;
}

LaserScan TurnAssembler::scan_of_turn() const {
  LaserScan scan;
  scan.angle_step_rad = angle_step_rad_;
  scan.angle_min_rad = 0.5 * angle_step_rad_ - std::numbers::pi;
  std::vector<scan::Echo> echoes;
  echoes.reserve(turn_.size());
  for (const TurningBeam& beam : turn_) {
    if (beam.range_m <= 0.0 || beam.range_m < settings_.range_min_m ||
        beam.range_m >= range_max_m_) {
      continue;
    }
    const double turned_rad = beam.turned_rad - std::numbers::pi + beam.aside_rad;
    const double angle_rad = mirrored_ ? -turned_rad : turned_rad;
    const geometry::SinCos direction = geometry::sincos(angle_rad);
    echoes.push_back({angle_rad, {beam.range_m * direction.cos, beam.range_m * direction.sin}});
  }
  scan.ranges_m =
      scan::on_grid(std::move(echoes), {scan.angle_min_rad, scan.angle_step_rad, beams_});
  const TurningBeam& first = turn_.front();
  const TurningBeam& last = turn_.back();
  const double s_per_rad = 1e-9 * static_cast<double>(last.time_ns - first.time_ns) /
                           (last.turned_rad - first.turned_rad);
  const double half_turn_s = s_per_rad * std::numbers::pi;
  scan.stamp_ns = first.time_ns + std::llround(1e9 * (half_turn_s - s_per_rad * first.turned_rad));
  const double sense = mirrored_ ? -1.0 : 1.0;
  scan.time_step_s = sense * s_per_rad * angle_step_rad_;
  scan.first_beam_s = sense * s_per_rad * scan.angle_min_rad;
  return scan;
}

}  // namespace topogeo::devices
