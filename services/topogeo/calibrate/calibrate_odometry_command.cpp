// topogeo calibrate-odometry: measures the odometry errors of a robot from one of its logs.
#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "calibrate/calibration_log.hpp"
#include "commands.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

using localization::LocalMaps;
using localization::NoiseParameter;
using localization::OdometryCalibration;

struct CalibrateOptions {
  std::filesystem::path log;
  recording::TopicChoice topics;
  std::optional<std::filesystem::path> reference;
  std::optional<std::filesystem::path> config;
  std::optional<std::filesystem::path> out;
};

/// All inputs, which are read before the work starts.
struct CalibrationInputs {
  pipeline::LoadedConfig config;
  OpenLog log;
  std::vector<topomap::StampedPose> reference;
};

std::vector<topomap::StampedPose> read_reference(const CalibrateOptions& options) {
  if (!options.reference) return {};
  try {
    auto reference = storage::read_trajectory_tum(*options.reference);
    std::stable_sort(reference.begin(), reference.end(),
                     [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
    return reference;
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

CalibrationInputs read_inputs(CalibrateOptions& options) {
  pipeline::LoadedConfig config =
      load_for_calibration(options.config, options.out, options.log, options.topics);
  auto reference = read_reference(options);
  OpenLog log = open_log(options.log, config.config.log, options.topics);
  return {std::move(config), std::move(log), std::move(reference)};
}

/// The measured motions of a log, and the source of the measurement for people.
struct Measured {
  LocalMaps maps;
  std::vector<localization::MeasuredMotion> motions;
  std::string yardstick;
};

Measured measure_by_reference(CalibrationInputs& inputs, const std::filesystem::path& reference) {
  Measured measured;
  measured.maps = make_maps(inputs.config.config, inputs.log);
  const double longest_path_m = inputs.config.config.localizer.recent_way_m;
  measured.motions =
      localization::motions_from_reference(measured.maps, inputs.reference, longest_path_m);
  if (measured.motions.empty()) {
    throw service::BadInputError(reference.string() +
                                 ": no two stops of the log lie within its time");
  }
  measured.yardstick = fmt::format("{} motions of up to {:g} m in {}", measured.motions.size(),
                                   longest_path_m, reference.filename().string());
  return measured;
}

Measured measure_by_matches(CalibrationInputs& inputs) {
  MatchedLog log = match_log(inputs.config.config, inputs.log);
  return {std::move(log.maps), log.matched.motions,
          describe_matches(inputs.config.config, log.matched)};
}

OdometryCalibration calibrate(const CalibrateOptions& options, const CalibrationInputs& inputs,
                              const Measured& measured) {
  try {
    Bar bar("refitting", "fits");
    OdometryCalibration found = localization::calibrate_odometry(
        localization::odometry_stretches(measured.maps), measured.motions,
        inputs.config.config.calibration,
        [&](std::size_t done, std::size_t total) { bar.update(done, total); });
    bar.finish();
    return found;
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(options.log.string() + ": " + error.what());
  }
}

/// Text for people and the file. Its three digits are more than the accuracy.
std::string digits(double value) {
  return fmt::format("{:.3g}", value);
}

std::string value_text(const localization::Estimate& estimate) {
  return fmt::format("{}{:.3g}", estimate.at_most ? "<" : "", estimate.value);
}

void print_table(std::ostream& out, const CalibrationInputs& inputs,
                 const OdometryCalibration& found) {
  const localization::OdometryNoise& configured = inputs.config.config.localizer.odometry;
  const auto row = [&](const auto&... cells) {
    out << fmt::format("{:<24}{:>10}{:>10}{:>12}{:>12}{:>10}{:>11}  {}\n", cells...);
  };
  row("parameter", "value", "spread", "configured", "corrected", "spread", "stretches", "unit");
  for (std::size_t p = 0; p < localization::kNoiseParameters; ++p) {
    const NoiseParameter& parameter = localization::kOdometryParameters[p];
    const localization::NoiseEstimate& estimate = found.parameters[p];
    const std::string now = digits(configured.*parameter.field);
    if (estimate.known) {
      row(parameter.key, value_text(estimate.as_is), digits(estimate.as_is.spread), now,
          value_text(estimate.corrected), digits(estimate.corrected.spread), estimate.stretches,
          parameter.unit);
      continue;
    }
    row(parameter.key, now, "-", now, now, "-", estimate.stretches, parameter.unit);
    out << fmt::format("  kept: only {} stretches have {}, {} are needed to estimate it\n",
                       estimate.stretches, parameter.per_turn ? "0.2 rad of turn" : "0.2 m of path",
                       localization::kFewestStretches);
  }
}

/// Matches are only searched within the configured noise.
void warn_of_narrow_search(std::ostream& out, const CalibrationInputs& inputs,
                           const OdometryCalibration& found) {
  constexpr double kFarAbove = 2.0;
  for (std::size_t p = 0; p < localization::kNoiseParameters; ++p) {
    const NoiseParameter& parameter = localization::kOdometryParameters[p];
    const double configured = inputs.config.config.localizer.odometry.*parameter.field;
    if (found.noise.*parameter.field <= kFarAbove * configured) continue;
    out << "  " << parameter.key
        << " is far above the configured value, so the worst motions may not have been matched:\n"
           "  run again with --config and the values found\n";
  }
}

void print_systematic(std::ostream& out, const localization::SystematicErrors& errors) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const auto line = [&](const char* name, const localization::Estimate& e, double factor,
                        const char* unit) {
    out << fmt::format("  {:<8}{:>+9.3f} +- {:<7.3f} {}\n", name, factor * e.value,
                       factor * e.spread, unit);
  };
  out << "systematic errors, counted as noise in `value`, taken out in `corrected`\n"
         "(+: the odometry reads too much, or drifts to the left):\n";
  line("distance", errors.distance, 100.0, "% of the distance");
  line("heading", errors.heading_rad_per_m, kDegrees, "degrees per m");
  line("turn", errors.turn, 100.0, "% of the turn");
  line("ahead", errors.ahead_m, 1.0, "m from laser.x_m to where the laser is");
  line("left", errors.left_m, 1.0, "m from laser.y_m to where the laser is");
  line("yaw", errors.yaw_rad, kDegrees, "degrees from laser.yaw_rad to where it points");
}

std::string yaml_block(const localization::OdometryNoise& noise) {
  std::string block = "odometry:\n";
  for (const NoiseParameter& parameter : localization::kOdometryParameters) {
    block += fmt::format("  {}: {}\n", parameter.key, digits(noise.*parameter.field));
  }
  return block;
}

int calibrate_log(CalibrateOptions options) {
  CalibrationInputs inputs = read_inputs(options);
  const Measured measured = options.reference ? measure_by_reference(inputs, *options.reference)
                                              : measure_by_matches(inputs);
  report_skipped(inputs.log.reader.statistics());
  const OdometryCalibration found = calibrate(options, inputs, measured);

  const std::string name = options.log.filename().string();
  std::cout << fmt::format("{}: {}\n", name, describe_drive(measured.maps)) << measured.yardstick
            << fmt::format("; {} outlying\n", found.outlying)
            << fmt::format("these measurements err {:.2f} times as much as they state\n\n",
                           found.measurement_scale);
  print_table(std::cout, inputs, found);
  if (!options.reference) warn_of_narrow_search(std::cout, inputs, found);
  std::cout << '\n';
  print_systematic(std::cout, found.systematic);
  std::cout << '\n';
  const std::string block = yaml_block(found.noise);
  std::cout << block;
  if (options.out) {
    const std::string comment = "Odometry of " + name + ", by topogeo calibrate-odometry.";
    support::write_file_atomically(
        *options.out, configuration_with(block, comment, options.config,
                                         inputs.config.config.local_mapper.T_robot_laser));
    std::cout << "written to " << options.out->string() << '\n';
  }
  return service::kOk;
}

}  // namespace

void add_calibrate_odometry_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "calibrate-odometry", "Estimate the odometry errors of a robot from a log");
  auto options = std::make_shared<CalibrateOptions>();
  add_topic_options(*command, options->topics);
  command->add_option("LOG", options->log, recording::kLogFormats)->required()->type_name("FILE");
  command
      ->add_option(
          "--reference", options->reference,
          "true trajectory of the robot (TUM) as the reference; without it, scans are matched")
      ->type_name("FILE");
  add_config_option(*command, options->config);
  command
      ->add_option(
          "--out", options->out,
          "configuration to write: the values found and, with --config, all of its other values")
      ->type_name("FILE");
  command->footer(
      "Drive some minutes with turns to both sides, through rooms rather than one long corridor.\n"
      "Example:\n"
      "  topogeo calibrate-odometry drive.clf.gz --out robot.yaml\n"
      "  topogeo map --log drive.clf.gz --config robot.yaml --out map");
  command->callback([options, &exit_code] { exit_code = calibrate_log(*options); });
}

}  // namespace topogeo::cli
