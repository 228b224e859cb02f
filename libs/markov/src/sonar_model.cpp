#include "topogeo/markov/sonar_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/check_range.hpp"

namespace topogeo::markov {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distances along a ray to the next border between columns (or rows), in cells.
struct BorderWalk {
  BorderWalk(double start, double direction) : step(direction < 0.0 ? -1 : 1) {
    if (direction == 0.0) return;
    const double below = std::floor(start);
    between = 1.0 / std::abs(direction);
    next = (direction < 0.0 ? start - below : below + 1.0 - start) * between;
  }
  int step;
  double next = kInfinity;
  double between = kInfinity;
};

}  // namespace

void check(std::span<const RangeSensor> sensors) {
  constexpr std::size_t kMost = 1000;
  if (sensors.empty() || sensors.size() > kMost) {
    throw std::invalid_argument(std::to_string(sensors.size()) +
                                " range sensors, must be 1 to 1000");
  }
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const std::string name = "range sensor " + std::to_string(i);
    const geometry::Pose2& mount = sensors[i].T_robot_sensor;
    support::check_range(name + ": x_m", mount.x_m, -5.0, 5.0);
    support::check_range(name + ": y_m", mount.y_m, -5.0, 5.0);
    support::check_range(name + ": theta_rad", mount.theta_rad, -100.0, 100.0);
    support::check_range(name + ": half_cone_rad", sensors[i].half_cone_rad, 0.0,
                         0.5 * std::numbers::pi);
  }
}

double reliability_of(const SonarModelConfig& config, double expected_m) {
  for (const ReliabilityBand& band : config.bands) {
    if (expected_m <= band.up_to_m) return band.reliability;
  }
  return 0.0;
}

SonarModel::SonarModel(std::vector<RangeSensor> sensors, const SonarModelConfig& config)
    : config_(config), sensors_(std::move(sensors)) {
  check(config_);
  check(sensors_);
}

void SonarModel::look_around(const ObstacleCells& map, const geometry::Pose2& T_map_robot,
                             int size) {
  size_ = size;
  cell_m_ = map.cell_m();
  const Cell centre = map.cell_of(T_map_robot.position_m());
  free_cells_of_window(map, centre, size, free_);
  asked_ = free_;
  const auto middle = static_cast<std::size_t>(size / 2);
  asked_[middle][middle / 64] |= std::uint64_t{1} << (middle % 64);
  double arm_m = 0.0;
  for (const RangeSensor& sensor : sensors_) {
    arm_m = std::max(arm_m, sensor.T_robot_sensor.position_m().norm());
  }
  take_surroundings(map, centre, arm_m + config_.max_range_m);

  const auto cells = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  virtual_m_.assign(sensors_.size() * cells, kInfinity);
  const Eigen::Vector2d place = map.place_in_cell(T_map_robot.position_m());
  const geometry::Pose2 T_window_robot{place.x() * cell_m_, place.y() * cell_m_,
                                       T_map_robot.theta_rad};
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const geometry::Pose2 T_window_sensor = T_window_robot * sensors_[i].T_robot_sensor;
    const Eigen::Vector2d start_cells = T_window_sensor.position_m() / cell_m_;
    const std::span<double> readings{virtual_m_.data() + i * cells, cells};
    const int side_rays = sensors_[i].half_cone_rad > 0.0 ? config_.rays_per_cone / 2 : 0;
    for (int ray = -side_rays; ray <= side_rays; ++ray) {
      const double off_axis_rad =
          side_rays == 0 ? 0.0 : sensors_[i].half_cone_rad * ray / side_rays;
      follow_ray(start_cells, T_window_sensor.theta_rad + off_axis_rad);
      cast(readings);
    }
  }
}

void SonarModel::take_surroundings(const ObstacleCells& map, Cell centre, double reach_m) {
  margin_ = static_cast<int>(std::ceil(reach_m / cell_m_)) + 2;
  const int rows = size_ + 2 * margin_;
  // Two words more than the bits need: surroundings_bits reads the word after its first one, and in
  // a wide window also after its second one.
  words_a_row_ = (rows + 63) / 64 + 2;
  surroundings_.resize(static_cast<std::size_t>(words_a_row_) * static_cast<std::size_t>(rows));
  const Cell corner{centre.x - size_ / 2 - margin_, centre.y - size_ / 2 - margin_};
  std::size_t i = 0;
  for (int row = 0; row < rows; ++row) {
    for (int word = 0; word < words_a_row_; ++word, ++i) {
      surroundings_[i] = map.occupied_bits(corner.x + 64 * word, corner.y + row);
    }
  }
}

std::uint64_t SonarModel::surroundings_bits(int x, int y) const {
  const std::uint64_t* word =
      surroundings_.data() + static_cast<std::ptrdiff_t>(y) * words_a_row_ + (x >> 6);
  const int shift = x & 63;
  // Shifted in two parts: a shift by 64 is undefined.
  return (word[0] >> shift) | ((word[1] << 1) << (63 - shift));
}

/// Fills crossings_ with the borders of cells, in order of distance.
void SonarModel::follow_ray(const Eigen::Vector2d& start_cells, double bearing_rad) {
  const geometry::SinCos direction = geometry::sincos(bearing_rad);
  BorderWalk columns{start_cells.x(), direction.cos};
  BorderWalk rows{start_cells.y(), direction.sin};
  Cell cell{static_cast<int>(std::floor(start_cells.x())),
            static_cast<int>(std::floor(start_cells.y()))};
  const double max_cells = config_.max_range_m / cell_m_;
  crossings_.clear();
  double entered = 0.0;
  while (entered <= max_cells) {
    crossings_.push_back({cell.x, cell.y, entered * cell_m_});
    const bool next_column = columns.next < rows.next;
    BorderWalk& walk = next_column ? columns : rows;
    (next_column ? cell.x : cell.y) += walk.step;
    entered = walk.next;
    walk.next += walk.between;
  }
}

/// Casts the ray of crossings_ from every requested cell at once: in each row of the window, cells
/// whose ray meets an obstacle at this crossing get their reading and are done.
void SonarModel::cast(std::span<double> readings) {
  open_ = asked_;
  const int words = (size_ + 63) / 64;
  for (const Crossing& crossing : crossings_) {
    std::uint64_t still_open = 0;
    for (int row = 0; row < size_; ++row) {
      for (int word = 0; word < words; ++word) {
        std::uint64_t& open = open_[static_cast<std::size_t>(row)][static_cast<std::size_t>(word)];
        std::uint64_t met =
            open & surroundings_bits(margin_ + crossing.x + 64 * word, margin_ + crossing.y + row);
        open &= ~met;
        still_open |= open;
        double* of_word = readings.data() + std::ptrdiff_t{row} * size_ + std::ptrdiff_t{64} * word;
        for (; met != 0; met &= met - 1) {
          double& reading = of_word[std::countr_zero(met)];
          reading = std::min(reading, crossing.distance_m);
        }
      }
    }
    if (still_open == 0) return;
  }
}

double SonarModel::virtual_m(std::size_t sensor, Cell offset) const {
  const std::ptrdiff_t half = size_ / 2;
  const std::ptrdiff_t cell = (offset.y + half) * size_ + offset.x + half;
  return virtual_m_[sensor * (virtual_m_.size() / sensors_.size()) +
                    static_cast<std::size_t>(cell)];
}

double SonarModel::probability_of(double difference_m) const {
  const double ratio = difference_m / config_.scale_m;
  switch (config_.formula) {
    case PerceptualFormula::kExponential:
      return geometry::exp(-ratio);
    case PerceptualFormula::kInverse:
      return 1.0 / (1.0 + ratio);
    case PerceptualFormula::kLinear:
      return std::max(0.0, 1.0 - ratio);
  }
  return 0.0;
}

/// Fills differences_, counts and rates the readings in `match`, and returns the sum of the weights
/// of the compared readings.
double SonarModel::add_differences(std::span<const float> ranges_m, PerceptualMatch& match) {
  const auto cells = static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_);
  differences_.assign(cells, 0.0);
  double weights = 0.0;
  double reliabilities = 0.0;
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (ranges_m[i] == scan::Scan::kNoReturn) continue;
    const double reliability = reliability_of(config_, virtual_m(i, {0, 0}));
    reliabilities += reliability;
    ++match.compared;
    const double weight = config_.weigh_by_reliability ? reliability : 1.0;
    weights += weight;
    const double real_m = std::min<double>(ranges_m[i], config_.max_range_m);
    const double* expected_m = virtual_m_.data() + i * cells;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      const double difference_m =
          std::abs(std::min(expected_m[cell], config_.max_range_m) - real_m);
      differences_[cell] += weight * std::min(difference_m, config_.difference_cap_m);
    }
  }
  match.reliability = reliabilities / static_cast<double>(sensors_.size());
  return weights;
}

PerceptualMatch SonarModel::compare(std::span<const float> ranges_m,
                                    std::span<double> probabilities) {
  if (ranges_m.size() != sensors_.size()) {
    throw std::invalid_argument(std::to_string(ranges_m.size()) + " readings of " +
                                std::to_string(sensors_.size()) + " range sensors");
  }
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    support::check_range("reading " + std::to_string(i), static_cast<double>(ranges_m[i]), 0.0, 1e6,
                         "m");
  }
  PerceptualMatch match{.best_difference_m = kInfinity};
  std::fill(probabilities.begin(), probabilities.end(), 0.0);
  const double weights = add_differences(ranges_m, match);
  if (weights <= 0.0) return match;
  double sum = 0.0;
  std::size_t cell = 0;
  for (int row = 0; row < size_; ++row) {
    for (int column = 0; column < size_; ++column, ++cell) {
      if (!bit_of(free_[static_cast<std::size_t>(row)], column)) continue;
      const double difference_m = differences_[cell] / weights;
      match.best_difference_m = std::min(match.best_difference_m, difference_m);
      probabilities[cell] = probability_of(difference_m);
      sum += probabilities[cell];
    }
  }
  match.informative = sum > 0.0;
  if (!match.informative) return match;
  for (double& probability : probabilities) probability /= sum;
  return match;
}

}  // namespace topogeo::markov
