// Robots that are carried away while they drive in a finished map: how soon the localizer reports
// it, and how far they drive until it is right again. Also fits the state monitor.
//
//   topogeo_kidnapped [--runs N] [--first-seed S] [--fit]
//
// Each run draws a floor, maps it in one drive, and drives it again with other noise; during the
// second drive the robot is put down elsewhere on its tour. The tables also show how often a
// TRACKING stop is right (0.3 m, 5 degrees; the truth relative to the nearest stop of the map), by
// its confidence. --fit prints the logistic functions of state_monitor.cpp that explain the matches
// and the predictions of these runs best; use different seeds for fit and table.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/random.hpp"

namespace {

using namespace topogeo;
using geometry::Pose2;
using localization::LocalizationState;

constexpr double kLeastJump_m = 4.0;

struct Sample {
  Eigen::Vector3d features;  // 1 and two numbers
  bool right = false;
};

struct Outcome {
  bool jumped = false;
  int stops_until_lost = -1;  // after the kidnapping; -1: never
  double way_until_right_m = -1.0;
  bool recovered_wrong = false;  // TRACKING at a wrong place after the kidnapping
  std::size_t stops_before = 0;
  std::size_t lost_before = 0;  // reported lost or searching before the kidnapping
};

struct Calibration {
  std::array<std::size_t, 10> stops{};
  std::array<std::size_t, 10> right{};
  std::array<double, 10> told{};
  std::size_t tracking = 0;
  std::size_t tracking_wrong = 0;
};

struct Samples {
  std::vector<Sample> matches;
  std::vector<Sample> predictions;
};

world::World floor_of(std::uint64_t seed) {
  switch (seed % 3) {
    case 0:
      return simulation::cyclic_floor(seed);
    case 1:
      return simulation::two_loops(seed);
    default:
      return simulation::corridor_there_and_back(seed);
  }
}

simulation::SimulationOptions options_of(std::uint64_t seed) {
  simulation::SimulationOptions options;
  options.seed = seed;
  options.scan_step_m = 0.35;
  options.scan_step_rad = 10.0 * std::numbers::pi / 180.0;
  options.odometry = simulation::b21_odometry(seed);
  return options;
}

bool is_near(const Pose2& pose, const Pose2& truth) {
  constexpr double kRight_m = 0.3;
  constexpr double kRight_rad = 0.0872664626;
  return (pose.position_m() - truth.position_m()).norm() <= kRight_m &&
         std::fabs(geometry::wrap_angle(pose.theta_rad - truth.theta_rad)) <= kRight_rad;
}

double way_of(const simulation::SimulatedLog& log) {
  double path_m = 0.0;
  for (std::size_t i = 1; i < log.T_world_robot.size(); ++i) {
    path_m += (log.T_world_robot[i].position_m() - log.T_world_robot[i - 1].position_m()).norm();
  }
  return path_m;
}

Eigen::Vector2d place_at(const simulation::SimulatedLog& log, double wanted_path_m) {
  double path_m = 0.0;
  for (std::size_t i = 1; i < log.T_world_robot.size(); ++i) {
    path_m += (log.T_world_robot[i].position_m() - log.T_world_robot[i - 1].position_m()).norm();
    if (path_m >= wanted_path_m) return log.T_world_robot[i].position_m();
  }
  return log.T_world_robot.back().position_m();
}

/// The truth in the frame of the map, by the nearest stop of the map.
struct TruthInMap {
  std::vector<Pose2> T_world_stop;
  std::vector<Pose2> T_map_stop;

  [[nodiscard]] Pose2 operator()(const Pose2& T_world_robot) const {
    std::size_t best = 0;
    double best_m2 = 1e300;
    for (std::size_t i = 0; i < T_world_stop.size(); ++i) {
      const double m2 = (T_world_stop[i].position_m() - T_world_robot.position_m()).squaredNorm();
      if (m2 < best_m2) {
        best = i;
        best_m2 = m2;
      }
    }
    return T_map_stop[best] * geometry::between(T_world_stop[best], T_world_robot);
  }
};

void collect(const localization::TrackedStep& step, const Pose2& truth, Samples& samples) {
  for (std::size_t i = 0; i < step.measured.size(); ++i) {
    const localization::StepMatch& match = step.evidence.matches[i];
    const bool counts = match.verdict == localization::Verdict::kAccepted ||
                        match.reason == localization::Reason::kDoubtful ||
                        match.reason == localization::Reason::kSecondSolution;
    if (counts) {
      samples.matches.push_back(
          {{1.0, match.doubt, match.rivalry}, is_near(step.measured[i], truth)});
    }
  }
  // Odometry's errors beyond its own covariance: is the robot within a metre of the prediction?
  samples.predictions.push_back(
      {{1.0, localization::contradiction(step.evidence), step.evidence.distance_m},
       (step.predicted.T_a_b.position_m() - truth.position_m()).norm() < 1.0});
}

/// A floor that was mapped in one drive.
struct MappedFloor {
  world::World world;
  simulation::SimulatedLog drive;
  std::shared_ptr<const localization::StoredMap> map;
  TruthInMap truth;
};

MappedFloor map_floor(std::uint64_t seed, const pipeline::Config& config) {
  MappedFloor floor{floor_of(seed), {}, {}, {}};
  floor.drive = simulation::simulate_log(floor.world, options_of(seed));
  pipeline::MappingRun mapping(config, "robot");
  for (const scan::Scan& scan : floor.drive.scans) mapping.add(scan);
  storage::MapDocument document = mapping.finish();
  for (const topomap::StopPose& stop : document.trajectory.stops) {
    floor.truth.T_map_stop.push_back(stop.T_map_robot);
    floor.truth.T_world_stop.push_back(
        floor.drive.T_world_robot[document.local_maps[stop.local_map_id].sequence]);
  }
  auto stored = std::make_shared<localization::StoredMap>();
  stored->maps = std::move(document.local_maps);
  stored->trajectory = document.trajectory;
  floor.map = std::move(stored);
  return floor;
}

/// Another drive on the floor, on which the robot is put down elsewhere.
simulation::SimulatedLog drive_and_kidnap(const MappedFloor& floor, std::uint64_t seed) {
  simulation::SimulationOptions options = options_of(seed + 1'000'000);
  support::Random random(seed);
  const double path_m = way_of(floor.drive);
  const double at_m = path_m * (0.25 + 0.25 * random.uniform());
  double to_m = 0.0;
  do {
    to_m = path_m * (0.05 + 0.75 * random.uniform());
  } while ((place_at(floor.drive, at_m) - place_at(floor.drive, to_m)).norm() < kLeastJump_m);
  options.kidnappings = {{at_m, to_m}};
  return simulation::simulate_log(floor.world, options);
}

bool is_known(LocalizationState state) {
  return state == LocalizationState::kTracking || state == LocalizationState::kAmbiguous;
}

/// Outcome of one run, from the localizer's status at each stop.
class Watch {
 public:
  void add_way(double step_m) {
    if (step_m > 0.5 * kLeastJump_m) {
      outcome_.jumped = true;
    } else if (outcome_.jumped) {
      way_since_m_ += step_m;
    }
  }

  void add_stop(LocalizationState state, bool right) {
    if (!outcome_.jumped) {
      ++outcome_.stops_before;
      outcome_.lost_before += is_known(state) ? 0 : 1;
      return;
    }
    ++stops_since_;
    if (!is_known(state) && outcome_.stops_until_lost < 0) {
      outcome_.stops_until_lost = stops_since_;
    }
    if (outcome_.stops_until_lost < 0 || state != LocalizationState::kTracking ||
        outcome_.way_until_right_m >= 0.0) {
      return;
    }
    if (right) {
      outcome_.way_until_right_m = way_since_m_;
    } else {
      outcome_.recovered_wrong = true;
    }
  }

  [[nodiscard]] const Outcome& outcome() const { return outcome_; }

 private:
  Outcome outcome_;
  int stops_since_ = 0;
  double way_since_m_ = 0.0;
};

void count(const localization::LocalizationStatus& belief, bool right, Calibration& calibration) {
  if (is_known(belief.state)) {
    const auto bin = std::min<std::size_t>(9, static_cast<std::size_t>(belief.confidence * 10.0));
    ++calibration.stops[bin];
    calibration.right[bin] += right ? 1 : 0;
    calibration.told[bin] += belief.confidence;
  }
  if (belief.state == LocalizationState::kTracking) {
    ++calibration.tracking;
    calibration.tracking_wrong += right ? 0 : 1;
  }
}

Outcome run(std::uint64_t seed, Calibration& calibration, Samples& samples) {
  const pipeline::Config config;
  const MappedFloor floor = map_floor(seed, config);
  const simulation::SimulatedLog drive = drive_and_kidnap(floor, seed);
  localization::InProcessPool pool;
  localization::MapTracker tracker(config.localizer, floor.map, pool);
  tracker.set_pose(floor.truth(drive.T_world_robot.front()),
                   Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal());
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  Watch watch;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    const Pose2& T_world_robot = drive.T_world_robot[i];
    if (i > 0) {
      watch.add_way((T_world_robot.position_m() - drive.T_world_robot[i - 1].position_m()).norm());
    }
    const auto map = mapper.add(drive.scans[i]);
    if (!map) continue;
    tracker.add(std::make_shared<const topomap::LocalMap>(*map));
    const Pose2 here = floor.truth(T_world_robot);
    const bool right = is_near(tracker.stops().back().T_map_robot, here);
    if (tracker.last_step()) collect(*tracker.last_step(), here, samples);
    const localization::LocalizationStatus belief = tracker.status();
    count(belief, right, calibration);
    watch.add_stop(belief.state, right);
  }
  return watch.outcome();
}

/// Newton's method, with a small penalty that keeps the weights finite.
Eigen::Vector3d fit(const std::vector<Sample>& samples) {
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  constexpr int kIterations = 30;
  constexpr double kPenalty = 0.1;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d hessian = kPenalty * Eigen::Matrix3d::Identity();
    Eigen::Vector3d gradient = -kPenalty * weights;
    for (const Sample& s : samples) {
      const double p = 1.0 / (1.0 + std::exp(-weights.dot(s.features)));
      gradient += ((s.right ? 1.0 : 0.0) - p) * s.features;
      hessian += p * (1.0 - p) * s.features * s.features.transpose();
    }
    weights += hessian.ldlt().solve(gradient);
  }
  return weights;
}

void print_fit(const char* name, const std::vector<Sample>& samples) {
  const Eigen::Vector3d w = fit(samples);
  const auto right =
      std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.right; });
  std::printf("%s: {%.2f, %.2f, %.2f} from %zu samples, %td right\n", name, w[0], w[1], w[2],
              samples.size(), right);
}

void print(const std::vector<Outcome>& outcomes, const Calibration& calibration) {
  std::size_t lost = 0;
  std::size_t lost_in_time = 0;
  std::size_t right = 0;
  std::size_t right_in_time = 0;
  std::size_t wrong = 0;
  std::size_t before = 0;
  std::size_t lost_before = 0;
  for (const Outcome& o : outcomes) {
    constexpr int kInTime = 3;
    constexpr double kInTime_m = 10.0;
    lost += o.stops_until_lost >= 0 ? 1 : 0;
    lost_in_time += o.stops_until_lost >= 0 && o.stops_until_lost <= kInTime ? 1 : 0;
    right += o.way_until_right_m >= 0.0 ? 1 : 0;
    right_in_time += o.way_until_right_m >= 0.0 && o.way_until_right_m <= kInTime_m ? 1 : 0;
    wrong += o.recovered_wrong ? 1 : 0;
    before += o.stops_before;
    lost_before += o.lost_before;
  }
  std::printf(
      "| runs | LOST within 3 stops | LOST at all | right again within 10 m | right again at "
      "all | TRACKING at a wrong place first | LOST before, of stops |\n"
      "|---|---|---|---|---|---|---|\n| %zu | %zu | %zu | %zu | %zu | %zu | %zu of %zu |\n\n",
      outcomes.size(), lost_in_time, lost, right_in_time, right, wrong, lost_before, before);
  std::printf("TRACKING: %zu stops, %zu of them wrong\n\n", calibration.tracking,
              calibration.tracking_wrong);
  std::printf("| confidence told | stops | mean told | right |\n|---|---|---|---|\n");
  for (std::size_t i = 0; i < calibration.stops.size(); ++i) {
    if (calibration.stops[i] == 0) continue;
    const auto n = static_cast<double>(calibration.stops[i]);
    std::printf("| %.1f to %.1f | %zu | %.3f | %.3f |\n", 0.1 * static_cast<double>(i),
                0.1 * static_cast<double>(i + 1), calibration.stops[i], calibration.told[i] / n,
                static_cast<double>(calibration.right[i]) / n);
  }
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("Robots that are carried away in a finished map");
  std::uint64_t runs = 100;
  std::uint64_t first_seed = 1;
  bool fitting = false;
  bool verbose = false;
  app.add_option("--runs", runs)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_flag("--fit", fitting, "print the logistic functions that these runs give");
  app.add_flag("--verbose", verbose, "one line for each run");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    std::vector<Outcome> outcomes;
    Calibration calibration;
    Samples samples;
    for (std::uint64_t seed = first_seed; seed < first_seed + runs; ++seed) {
      const Outcome o = run(seed, calibration, samples);
      outcomes.push_back(o);
      if (!verbose) continue;
      std::fprintf(
          stderr, "seed %llu: jumped %d, lost after %d, right after %.1f m, wrong %d, %zu of %zu\n",
          static_cast<unsigned long long>(seed), o.jumped, o.stops_until_lost, o.way_until_right_m,
          o.recovered_wrong, o.lost_before, o.stops_before);
    }
    if (fitting) {
      print_fit("kMatchRight", samples.matches);
      print_fit("kOdometryRight", samples.predictions);
    }
    print(outcomes, calibration);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_kidnapped: %s\n", error.what());
    return 1;
  }
  return 0;
}
