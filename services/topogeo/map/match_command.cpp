// topogeo match: searches the relative pose of two stops; output as text, JSON and a picture.
#include <algorithm>
#include <charconv>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/pipeline/stop_search.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/render/match_picture.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

using geometry::Pose2;
using localization::UncertainPose;
using pipeline::FitnessParts;
using pipeline::StopSearch;

struct MatchOptions {
  std::filesystem::path source;
  std::string stops;
  std::optional<std::filesystem::path> out;
  std::optional<std::filesystem::path> config;
  std::string prediction = "odometry";
  std::optional<std::string> predicted;
  std::optional<std::uint32_t> solutions;
  bool json = false;
  std::uint32_t width_px = 1600;
};

/// Numbers of the reference stop and the query stop.
struct Pair {
  std::size_t reference = 0;
  std::size_t query = 0;
};

Pair parse_pair(const std::string& text) {
  Pair pair;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, pair.reference);
  if (first.ec == std::errc{} && first.ptr != end && *first.ptr == ',') {
    const auto second = std::from_chars(first.ptr + 1, end, pair.query);
    if (second.ec == std::errc{} && second.ptr == end) return pair;
  }
  throw std::invalid_argument("--stops " + text + ": expected two numbers, like 12,80");
}

/// Stops of a drive, with their poses if they come from a map.
struct Stops {
  std::vector<topomap::LocalMap> maps;
  std::vector<topomap::StopPose> poses;
};

/// Whether the file is a map, by the extension of its name; other files are read as logs.
bool is_map(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".pb" || ending == ".sqlite";
}

Stops stops_of_map(const std::filesystem::path& file) {
  try {
    storage::MapDocument document = storage::read_map(file);
    return {std::move(document.local_maps), std::move(document.trajectory.stops)};
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

Stops stops_of_log(const std::filesystem::path& file, const pipeline::Config& config,
                   const recording::TopicChoice& topics, std::size_t last) {
  Stops stops;
  try {
    recording::LogReader reader(file, config.log, topics);
    pipeline::LocalMapper mapper(config.local_mapper, "robot");
    const auto keep = [&](std::optional<topomap::LocalMap> map) {
      if (!map) return;
      // Numbered like the stops of a map of this log.
      stops.maps.push_back(
          topomap::numbered(std::move(*map), static_cast<std::uint32_t>(stops.maps.size()), false));
    };
    while (stops.maps.size() <= last) {
      const std::optional<scan::Scan> scan = reader.next();
      if (!scan) {
        keep(mapper.finish());
        break;
      }
      keep(mapper.add(*scan));
    }
    report_skipped(reader.statistics());
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  return stops;
}

UncertainPose predict(const MatchOptions& options, const Pair& pair, const Stops& stops,
                      const pipeline::Config& config) {
  pipeline::check_stops(stops.maps.size(), pair.reference, pair.query);
  if (options.predicted) {
    return {pipeline::parse_pose(*options.predicted), localization::given_pose_covariance()};
  }
  if (options.prediction == "odometry") {
    return pipeline::predict_by_odometry(stops.maps, pair.reference, pair.query,
                                         config.localizer.odometry);
  }
  if (std::max(pair.reference, pair.query) >= stops.poses.size()) {
    throw std::invalid_argument("--prediction map: it is not known where the stops are");
  }
  return {geometry::between(stops.poses[pair.reference].T_map_robot,
                            stops.poses[pair.query].T_map_robot),
          localization::given_pose_covariance()};
}

std::string pose_text(const Pose2& T) {
  return fmt::format("x {:.3f} m, y {:.3f} m, {:.2f} deg", T.x_m, T.y_m,
                     T.theta_rad * 180.0 / std::numbers::pi);
}

std::string parts_text(const FitnessParts& parts) {
  return fmt::format("scan {:.3f}, topological {:.3f}, prior {:.3f}", parts.scan, parts.topological,
                     parts.prior);
}

std::vector<std::string> lines_of(const StopSearch& search) {
  const localization::MatchTask& task = search.task;
  const localization::MatchResult& result = search.result;
  std::vector<std::string> lines{fmt::format(
      "predicted: {}; searched: {:.2f} m, {:.2f} m and {:.1f} deg to each side; ellipse "
      "{:.2f} m by {:.2f} m",
      pose_text(task.T_reference_query), task.half_width.x(), task.half_width.y(),
      task.half_width.z() * 180.0 / std::numbers::pi, search.ellipse.semi_major_m,
      search.ellipse.semi_minor_m)};
  for (std::size_t i = 0; i < result.solutions.size(); ++i) {
    lines.push_back(fmt::format("solution {}: {}; fitness {:.3f}: {}", i + 1,
                                pose_text(result.solutions[i].T_reference_query),
                                result.solutions[i].fitness, parts_text(search.solutions[i])));
  }
  if (result.status == localization::MatchStatus::kSolved) {
    lines.push_back(fmt::format("refined: {}; fitness {:.3f}: {}",
                                pose_text(result.T_reference_query), result.fitness,
                                parts_text(search.refined)));
    lines.push_back(fmt::format(
        "evidence: overlap {:.2f}, inliers {:.2f}, violations {:.3f}, residual {:.3f} m, doubt "
        "{:.2f}; second pose: {}",
        result.overlap, result.inliers, result.violations, result.residual_rms_m,
        localization::doubt(result),
        result.second.fitness > 0.0
            ? fmt::format("fitness {:.3f}, rivalry {:.2f}", result.second.fitness,
                          localization::rivalry(task, result))
            : "none"));
  }
  lines.push_back(fmt::format("verdict: {}{}", localization::to_string(result.verdict),
                              result.verdict == localization::Verdict::kAccepted
                                  ? std::string()
                                  : fmt::format(" ({})", localization::to_string(result.reason))));
  return lines;
}

nlohmann::ordered_json json_of_pose(const Pose2& T) {
  return {{"x_m", T.x_m}, {"y_m", T.y_m}, {"theta_rad", T.theta_rad}};
}

nlohmann::ordered_json json_of_parts(const Pose2& T, double fitness, const FitnessParts& parts) {
  return {{"T_reference_query", json_of_pose(T)},
          {"fitness", fitness},
          {"scan_fitness", parts.scan},
          {"topological_fitness", parts.topological},
          {"prior", parts.prior}};
}

nlohmann::ordered_json json_of_search(const Pair& pair, const StopSearch& search) {
  const localization::MatchTask& task = search.task;
  const localization::MatchResult& result = search.result;
  auto solutions = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < result.solutions.size(); ++i) {
    solutions.push_back(json_of_parts(result.solutions[i].T_reference_query,
                                      result.solutions[i].fitness, search.solutions[i]));
  }
  nlohmann::ordered_json out = {{"reference", pair.reference},
                                {"query", pair.query},
                                {"predicted", json_of_pose(task.T_reference_query)},
                                {"half_width",
                                 {{"x_m", task.half_width.x()},
                                  {"y_m", task.half_width.y()},
                                  {"theta_rad", task.half_width.z()}}},
                                {"ellipse",
                                 {{"semi_major_m", search.ellipse.semi_major_m},
                                  {"semi_minor_m", search.ellipse.semi_minor_m},
                                  {"direction_rad", search.ellipse.direction_rad}}},
                                {"evaluations", result.evaluations},
                                {"solutions", solutions},
                                {"refined", nullptr},
                                {"second", nullptr},
                                {"verdict", localization::to_string(result.verdict)},
                                {"reason", localization::to_string(result.reason)}};
  if (result.status != localization::MatchStatus::kSolved) return out;
  out["refined"] = json_of_parts(result.T_reference_query, result.fitness, search.refined);
  out["refined"]["overlap"] = result.overlap;
  out["refined"]["inliers"] = result.inliers;
  out["refined"]["violations"] = result.violations;
  out["refined"]["residual_rms_m"] = result.residual_rms_m;
  out["refined"]["doubt"] = localization::doubt(result);
  if (result.second.fitness > 0.0) {
    out["second"] = {{"T_reference_query", json_of_pose(result.second.T_reference_query)},
                     {"fitness", result.second.fitness},
                     {"rivalry", localization::rivalry(task, result)}};
  }
  return out;
}

void draw(const MatchOptions& options, const Pair& pair, const Stops& stops,
          const StopSearch& search, const std::vector<std::string>& lines) {
  render::MatchPicture picture;
  picture.reference = &stops.maps[pair.reference];
  picture.query = &stops.maps[pair.query];
  picture.T_predicted = search.task.T_reference_query;
  picture.ellipse_major_m = search.ellipse.semi_major_m;
  picture.ellipse_minor_m = search.ellipse.semi_minor_m;
  picture.ellipse_direction_rad = search.ellipse.direction_rad;
  picture.half_width_m = search.task.half_width.head<2>();
  for (const localization::MatchSolution& solution : search.result.solutions) {
    picture.solutions.push_back(solution.T_reference_query);
  }
  picture.found = search.result.status == localization::MatchStatus::kSolved;
  picture.T_found = search.result.T_reference_query;
  picture.title = fmt::format("{}: stop {} searched in stop {}", options.source.filename().string(),
                              pair.query, pair.reference);
  picture.lines = lines;
  support::write_file_atomically(
      *options.out, render::match_picture(picture, render::picture_format(*options.out),
                                          {.max_width_px = options.width_px}));
}

int match_stops(const MatchOptions& options) {
  Pair pair;
  pipeline::LoadedConfig config;
  try {
    if (options.out) (void)render::picture_format(*options.out);
    pair = parse_pair(options.stops);
    config = pipeline::load_config(options.config);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  if (options.solutions) config.config.localizer.solutions_wanted = *options.solutions;
  Stops stops;
  if (is_map(options.source)) {
    stops = stops_of_map(options.source);
  } else {
    recording::TopicChoice topics;
    choose_mounting(config, options.source, topics);
    stops =
        stops_of_log(options.source, config.config, topics, std::max(pair.reference, pair.query));
  }
  UncertainPose predicted;
  try {
    predicted = predict(options, pair, stops, config.config);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  const StopSearch search = pipeline::search_stop(
      stops.maps[pair.reference], stops.maps[pair.query], predicted, config.config.localizer);
  const std::vector<std::string> lines = lines_of(search);
  if (options.json) {
    std::cout << json_of_search(pair, search).dump(2) << '\n';
  } else {
    for (const std::string& line : lines) std::cout << line << '\n';
  }
  if (options.out) draw(options, pair, stops, search, lines);
  return service::kOk;
}

}  // namespace

void add_match_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "match", "Show the search for the relative pose of two stops, with its space and results");
  auto options = std::make_shared<MatchOptions>();
  command
      ->add_option("source", options->source,
                   "log (see `topogeo map --help`), or a map (.pb, .sqlite)")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--stops", options->stops, "the reference and the one that is searched, from 0")
      ->required()
      ->type_name("I,J");
  command->add_option("--out", options->out, "picture to write: .png or .svg")->type_name("FILE");
  command->add_flag("--json", options->json, "print JSON");
  command
      ->add_option("--solutions", options->solutions, "solutions to show; default: as configured")
      ->check(command_line::range(1U, 40U))
      ->type_name("N");
  command_line::Option* prediction =
      command->add_option("--prediction", options->prediction, "source of the predicted pose")
          ->check(command_line::one_of({"odometry", "map"}))
          ->capture_default_str();
  command
      ->add_option("--predicted", options->predicted, "x,y,degrees of the query in the reference")
      ->excludes(prediction);
  add_width_option(*command, options->width_px);
  add_config_option(*command, options->config);
  command->footer(
      "Stops are numbered as in the map of the log. Poses are of the query's robot in the frame\n"
      "of the reference's. A search is as wide as the prediction is uncertain, within the limits\n"
      "of the configuration, so stops far apart want --prediction map or --predicted.");
  command->callback([options, &exit_code] { exit_code = match_stops(*options); });
}

}  // namespace topogeo::cli
