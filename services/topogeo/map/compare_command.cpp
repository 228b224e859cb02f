// topogeo compare: the errors of a trajectory against a reference, and the revisits recognized by a
// map.
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/relations.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "common/configuration.hpp"
#include "map/compare_loops.hpp"

namespace topogeo::cli {
namespace {

using pipeline::RelationsError;
using pipeline::RelationSpread;
using pipeline::RelativeError;
using pipeline::TrajectoryError;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

struct CompareOptions {
  std::filesystem::path estimate;
  std::filesystem::path reference;
  std::optional<std::filesystem::path> relations;
  std::optional<std::filesystem::path> config;  ///< for the mounting of the laser
  double max_apart_s = 0.05;
  bool loops = false;
  std::optional<std::filesystem::path> report;  ///< of the loops
  bool json = false;

  [[nodiscard]] std::int64_t max_apart_ns() const {
    return static_cast<std::int64_t>(std::llround(max_apart_s * 1e9));
  }
};

struct Figures {
  TrajectoryError error;
  std::optional<RelationsError> relations;
};

geometry::Pose2 laser_of(const std::optional<std::filesystem::path>& config) {
  if (!config) return {};
  return read_config(config).local_mapper.T_robot_laser;
}

std::vector<topomap::StampedPose> read_poses(const std::filesystem::path& file) {
  std::vector<topomap::StampedPose> poses = storage::read_trajectory_tum(file);
  if (poses.empty()) throw std::runtime_error(file.string() + ": has no poses");
  return poses;
}

Figures figures_of(const CompareOptions& options) {
  const geometry::Pose2 T_robot_laser = laser_of(options.config);
  try {
    std::vector<topomap::StampedPose> estimate = read_poses(options.estimate);
    for (topomap::StampedPose& pose : estimate) pose.pose = pose.pose * T_robot_laser;
    const std::vector<topomap::StampedPose> reference = read_poses(options.reference);
    std::optional<RelationsError> relations;
    if (options.relations) {
      const auto given = storage::read_relations(*options.relations);
      if (given.empty()) {
        throw std::runtime_error(options.relations->string() + ": has no relations");
      }
      relations = pipeline::relations_error(estimate, given);
    }
    return {pipeline::trajectory_error(estimate, reference, options.max_apart_ns()), relations};
  } catch (const std::invalid_argument& error) {  // thrown without file names
    throw service::BadInputError(options.estimate.string() + " and " + options.reference.string() +
                                 ": " + error.what());
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

std::string text(const RelativeError& error) {
  return fmt::format("{:.3f} m {:.2f} deg over {} pairs", error.mean_m,
                     kDegreesPerRadian * error.mean_rad, error.pairs);
}

std::string text(const RelationSpread& error) {
  return fmt::format("{:.4f} +- {:.4f} m  {:.3f} +- {:.3f} deg over {} pairs", error.mean_m,
                     error.deviation_m, kDegreesPerRadian * error.mean_rad,
                     kDegreesPerRadian * error.deviation_rad, error.pairs);
}

template <typename Error>
std::string text(const std::optional<Error>& error) {
  return error ? text(*error) : "none";
}

void print_errors(const Figures& figures) {
  const TrajectoryError& e = figures.error;
  std::cout << fmt::format("matched {:.3f}  path {:.0f} m\n", e.matched, e.path_m)
            << fmt::format("ate     {:.3f} m\n", e.rms_m)
            << fmt::format("local   {}\n", text(e.local))
            << fmt::format("loop    {}\n", text(e.loop))
            << fmt::format("end     {:.3f} m\n", e.end_m);
  if (!figures.relations) return;
  std::cout << fmt::format("relations ({} in the file)\n", figures.relations->given)
            << fmt::format("  all   {}\n", text(figures.relations->all))
            << fmt::format("  far   {}\n", text(figures.relations->far));
}

nlohmann::ordered_json json(const RelativeError& error) {
  return {{"m", error.mean_m}, {"deg", kDegreesPerRadian * error.mean_rad}, {"pairs", error.pairs}};
}

nlohmann::ordered_json json(const RelationSpread& error) {
  return {{"m", error.mean_m},
          {"m_std", error.deviation_m},
          {"deg", kDegreesPerRadian * error.mean_rad},
          {"deg_std", kDegreesPerRadian * error.deviation_rad},
          {"pairs", error.pairs}};
}

template <typename Error>
nlohmann::ordered_json json(const std::optional<Error>& error) {
  return error ? json(*error) : nlohmann::ordered_json(nullptr);
}

void print_errors_json(const Figures& figures) {
  const TrajectoryError& e = figures.error;
  nlohmann::ordered_json all = {{"matched", e.matched}, {"ate", e.rms_m}, {"local", json(e.local)},
                                {"loop", json(e.loop)}, {"end", e.end_m}, {"path", e.path_m}};
  if (figures.relations) {
    all["relations"] = {{"in_file", figures.relations->given},
                        {"all", json(figures.relations->all)},
                        {"far", json(figures.relations->far)}};
  }
  std::cout << all.dump() << '\n';
}

void check_options(const CompareOptions& options) {
  if (options.loops) {
    if (options.relations) throw service::UsageError("--relations excludes --loops");
    return;
  }
  if (options.report) throw service::UsageError("--report needs --loops");
  if (options.estimate.extension() == ".pb") {
    throw service::UsageError(fmt::format(
        "{} is a map, expected a trajectory (TUM) such as trajectory.tum; --loops compares the "
        "loops of a map",
        options.estimate.string()));
  }
}

int compare_files(const CompareOptions& options) {
  check_options(options);
  if (options.loops) {
    print_loops({options.estimate, options.reference, options.report, laser_of(options.config),
                 options.max_apart_ns(), options.json});
    return service::kOk;
  }
  const Figures figures = figures_of(options);
  if (options.json) {
    print_errors_json(figures);
  } else {
    print_errors(figures);
  }
  return service::kOk;
}

}  // namespace

void add_compare_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "compare", "Compare a trajectory, or the loops of a map, with a reference trajectory");
  auto options = std::make_shared<CompareOptions>();
  command
      ->add_option("ESTIMATE", options->estimate,
                   "trajectory (TUM: t x y z qx qy qz qw); with --loops a map (map.pb)")
      ->required()
      ->type_name("FILE");
  command->add_option("REFERENCE", options->reference, "trajectory to compare it with (TUM)")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--relations", options->relations,
                   "hand-checked relative poses, lines `t1 t2 x y z roll pitch yaw`")
      ->type_name("FILE");
  command
      ->add_option("--max-dt", options->max_apart_s,
                   "largest time between two poses that are compared")
      ->check(command_line::range(0.0, 3600.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  command
      ->add_option(
          "--config", options->config,
          "configuration (YAML) with the place of the laser: the reference is of the laser")
      ->type_name("FILE");
  command->add_flag("--loops", options->loops,
                    "compare the loop closures of the map ESTIMATE with its revisits");
  command
      ->add_option("--report", options->report,
                   "report of the run that made the map; default: report.json beside it")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "print JSON, unrounded");
  command->footer(
      "Both trajectories must be of the same point of the robot. topogeo writes poses of the "
      "point\n"
      "that odometry refers to; many references are of the laser: where laser.x_m, y_m or yaw_rad\n"
      "are not 0, name a configuration with them (report.json lists those in force) with --config\n"
      "to compare the poses of the laser.\n"
      "What is printed (metres, degrees):\n"
      "  matched    share of the reference poses that the estimate has, and the path between them\n"
      "  ate        root mean square distance after the best rigid alignment\n"
      "  local      mean error from each pose to the next\n"
      "  loop       mean error between poses that are within 1.5 m of each other in the reference\n"
      "             although more than 20 m of path lie between: small in a map that closes\n"
      "  end        distance of the last poses when the first ones coincide\n"
      "  relations  mean and standard deviation of the errors of the relations that the estimate\n"
      "             has poses for (within 1 ms): all, and far: over 30 s apart\n"
      "With --loops:\n"
      "  revisits   stops within 2 m and 57 degrees of a stop 30 or more stops older\n"
      "  tried      revisits that were compared with at least one of these older stops\n"
      "  accepted   revisits with at least one loop to them\n"
      "  in view    revisits that see the same as one of them: half of the points are in its "
      "view,\n"
      "             and within 0.2 m of its points or outline, when the reference places both\n"
      "  wrong      loops more than 0.6 m or 0.2 rad off the reference, whose scans have no more "
      "in\n"
      "             common than by the reference\n"
      "  rejected   decisions within 0.25 m and 0.09 rad of the reference that gave no loop\n"
      "and all decisions by source and outcome: right as rejected ones are, near (within 0.6 m "
      "and\n"
      "0.2 rad) or wrong.\n"
      "Examples:\n"
      "  topogeo compare out/trajectory.tum truth.tum\n"
      "  topogeo compare out/map.pb truth.tum --loops");
  command->callback([options, &exit_code] { exit_code = compare_files(*options); });
}

}  // namespace topogeo::cli
