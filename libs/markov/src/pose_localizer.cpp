#include "topogeo/markov/pose_localizer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/markov/sonar_model.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/support/check_range.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::markov {
namespace {

constexpr double kBin_m = 0.01;  ///< of the tables of probabilities by expected distance

PoseGrid window_of(const PoseGridConfig& config) {
  return {static_cast<int>(std::lround(config.window_m / config.cell_m)), config.cell_m,
          static_cast<int>(std::lround(config.heading_window_rad / config.heading_step_rad)),
          config.heading_step_rad};
}

double normal_density(double off_m, double sigma_m) {
  const double ratio = off_m / sigma_m;
  return geometry::exp(-0.5 * ratio * ratio) / (sigma_m * std::sqrt(2.0 * std::numbers::pi));
}

/// Uniform up to far_off_m, with ends blurred like an exact reading.
double far_density(double off_m, const PoseGridConfig& config) {
  const double inside = 0.5 + 0.5 * (config.far_off_m - off_m) / config.hit_sigma_m;
  return std::clamp(inside, 0.0, 1.0) / (2.0 * config.far_off_m);
}

}  // namespace

PoseLocalizer::PoseLocalizer(const PoseGridConfig& config, ObstacleCells map,
                             std::vector<RangeSensor> sensors, double max_range_m,
                             const geometry::Pose2& T_map_station)
    : config_((check(config), config)),
      map_(std::move(map)),
      sensors_(std::move(sensors)),
      max_range_m_(max_range_m),
      grid_(window_of(config)),
      T_map_expected_(T_map_station) {
  check(sensors_);
  std::vector<double> angles;
  for (const RangeSensor& sensor : sensors_) {
    const auto same = std::ranges::find(angles, sensor.half_cone_rad);
    cone_of_.push_back(static_cast<std::size_t>(same - angles.begin()));
    if (same != angles.end()) continue;
    angles.push_back(sensor.half_cone_rad);
  }
  for (const double angle_rad : angles) cones_.emplace_back(map_, angle_rad, max_range_m_);
  if (!map_.free(map_.cell_of(T_map_station.position_m()))) {
    reason_ = fmt::format("the base station at {:.2f}, {:.2f} is not in a free cell of the map",
                          T_map_station.x_m, T_map_station.y_m);
  }
  grid_.set_normal(config_.station_sigma_m, config_.station_sigma_rad);
  update_estimate();
}

void PoseLocalizer::move(const geometry::Pose2& T_robot_then_now) {
  const geometry::SinCos heading = geometry::sincos(T_map_expected_.theta_rad);
  const Eigen::Vector2d step_m = T_robot_then_now.position_m();
  const Eigen::Vector2d map_step_m(heading.cos * step_m.x() - heading.sin * step_m.y(),
                                   heading.sin * step_m.x() + heading.cos * step_m.y());
  const double path_m = step_m.norm();
  const double turn_rad = std::fabs(T_robot_then_now.theta_rad);
  T_map_expected_ = T_map_expected_ * T_robot_then_now;
  grid_.drive(map_step_m);
  const auto sum = [](double sigma_a, double amount_a, double sigma_b, double amount_b) {
    return std::sqrt(sigma_a * sigma_a * amount_a + sigma_b * sigma_b * amount_b);
  };
  grid_.blur(sum(config_.path_sigma_m, path_m, config_.turn_sigma_m, turn_rad),
             sum(config_.path_sigma_rad, path_m, config_.turn_sigma_rad, turn_rad));
  keep_free_cells();
  update_estimate();
}

void PoseLocalizer::keep_free_cells() {
  const int side = grid_.side();
  const std::span<double> values = grid_.values();
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Eigen::Vector2d off_m(grid_.offset_m(x), grid_.offset_m(y));
      if (map_.free(map_.cell_of(T_map_expected_.position_m() + off_m))) continue;
      for (int h = 0; h < grid_.headings(); ++h) values[grid_.index(x, y, h)] = 0.0;
    }
  }
  if (grid_.normalize()) return;
  reason_ = "every free cell of the window has probability 0";
  grid_.set_uniform();
}

/// Logarithm of the probability of a reading by the expected distance, in bins.
void PoseLocalizer::make_log_table(double reading_m, std::vector<float>& table) const {
  const auto bins = static_cast<std::size_t>(max_range_m_ / kBin_m) + 2;
  table.resize(bins);
  const double any = (1.0 - config_.hit_share - config_.short_share) / max_range_m_;
  for (std::size_t i = 0; i < bins; ++i) {
    const double expected_m = static_cast<double>(i) * kBin_m;
    double density = any;
    if (expected_m < max_range_m_ - kBin_m) {
      const double off_m = std::fabs(reading_m - expected_m);
      const double near = normal_density(off_m, config_.hit_sigma_m);
      const bool far = expected_m > config_.far_from_m;
      const double off_share = far ? config_.far_off_share : 0.0;
      density +=
          config_.hit_share * ((1.0 - off_share) * near + off_share * far_density(off_m, config_));
    }
    if (reading_m < expected_m) density += config_.short_share / expected_m;
    table[i] = static_cast<float>(geometry::log(density));
  }
}

void PoseLocalizer::weigh(std::span<const float> ranges_m) {
  std::vector<std::vector<float>> tables(sensors_.size());
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (ranges_m[i] == scan::Scan::kNoReturn) continue;
    make_log_table(std::min<double>(ranges_m[i], max_range_m_), tables[i]);
  }
  const int side = grid_.side();
  const std::span<double> values = grid_.values();
  std::vector<double> logs(values.size(), 0.0);
  double most = -1e300;
  struct Turned {
    Eigen::Vector2d at_m;
    int bearing;
    const float* table;
    ConeRanges* cone;
  };
  std::vector<Turned> turned;
  for (int h = 0; h < grid_.headings(); ++h) {
    const geometry::Pose2 heading{
        0.0, 0.0, geometry::wrap_angle(T_map_expected_.theta_rad + grid_.offset_rad(h))};
    turned.clear();
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
      if (tables[i].empty()) continue;
      const geometry::Pose2 T = heading * sensors_[i].T_robot_sensor;
      turned.push_back({T_map_expected_.position_m() + T.position_m(),
                        ConeRanges::bearing_index(T.theta_rad), tables[i].data(),
                        &cones_[cone_of_[i]]});
    }
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const std::size_t cell = grid_.index(x, y, h);
        if (values[cell] == 0.0) continue;
        const Eigen::Vector2d off_m(grid_.offset_m(x), grid_.offset_m(y));
        double log_sum = 0.0;
        for (const Turned& sensor : turned) {
          const std::uint16_t mm = sensor.cone->range_mm(sensor.at_m + off_m, sensor.bearing);
          log_sum += static_cast<double>(sensor.table[(mm + 5U) / 10U]);
        }
        logs[cell] = config_.evidence * log_sum;
        most = std::max(most, logs[cell]);
      }
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] != 0.0) values[i] *= geometry::exp(logs[i] - most);
  }
}

void PoseLocalizer::perceive(std::span<const float> ranges_m) {
  if (ranges_m.size() != sensors_.size()) {
    throw std::invalid_argument(
        fmt::format("{} readings of {} range sensors", ranges_m.size(), sensors_.size()));
  }
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    support::check_range("reading " + std::to_string(i), static_cast<double>(ranges_m[i]), 0.0, 1e6,
                         "m");
  }
  weigh(ranges_m);
  keep_free_cells();
  update_estimate();
  watch_agreement(ranges_m);
}

void PoseLocalizer::watch_agreement(std::span<const float> ranges_m) {
  constexpr double kAgrees = 3.0;  // sigmas
  constexpr double kSmoothing = 0.1;
  int compared = 0;
  int agreed = 0;
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (ranges_m[i] == scan::Scan::kNoReturn || ranges_m[i] > config_.far_from_m) continue;
    const geometry::Pose2 T = estimate_.T_map_robot * sensors_[i].T_robot_sensor;
    const double expected_m = cones_[cone_of_[i]].range_m(T.position_m(), T.theta_rad);
    ++compared;
    const double off_m = std::fabs(static_cast<double>(ranges_m[i]) - expected_m);
    agreed += off_m <= kAgrees * config_.hit_sigma_m ? 1 : 0;
  }
  if (compared == 0) return;
  agreement_ += kSmoothing * (static_cast<double>(agreed) / compared - agreement_);
  if (agreement_ >= config_.least_agreement) {
    reason_.clear();
    return;
  }
  if (!reason_.empty()) return;
  reason_ = fmt::format("{:.0f} % of the readings agree with the map", 100.0 * agreement_);
  grid_.set_uniform();
  keep_free_cells();
  update_estimate();
}

/// Computes mean and covariance and shifts the grid so that the mean is near its middle.
void PoseLocalizer::update_estimate() {
  const PoseGrid::Moments moments = grid_.moments();
  const auto cells = [&](double offset_m) {
    return static_cast<int>(std::lround(offset_m / grid_.cell_m()));
  };
  const int by_x = cells(moments.mean.x());
  const int by_y = cells(moments.mean.y());
  const int by_heading = static_cast<int>(std::lround(moments.mean.z() / grid_.heading_step_rad()));
  estimate_.T_map_robot = {T_map_expected_.x_m + moments.mean.x(),
                           T_map_expected_.y_m + moments.mean.y(),
                           geometry::wrap_angle(T_map_expected_.theta_rad + moments.mean.z())};
  estimate_.covariance = moments.covariance;
  constexpr int kFar_cells = 3;  // shifting loses values at the edge
  if (std::abs(by_x) < kFar_cells && std::abs(by_y) < kFar_cells && by_heading == 0) return;
  grid_.shift(-by_x, -by_y, -by_heading);
  T_map_expected_.x_m += by_x * grid_.cell_m();
  T_map_expected_.y_m += by_y * grid_.cell_m();
  T_map_expected_.theta_rad =
      geometry::wrap_angle(T_map_expected_.theta_rad + by_heading * grid_.heading_step_rad());
  grid_.normalize();
}

}  // namespace topogeo::markov
