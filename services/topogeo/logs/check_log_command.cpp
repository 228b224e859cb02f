// topogeo check-log: reports the faults of a log before hours are spent on it.
#include <iostream>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

// Exit codes of this command only, so that scripts can distinguish a faulty log from a file that
// is no log.
constexpr int kClean = 0;
constexpr int kFaulty = 1;
constexpr int kUnreadable = 2;

double duration_s(const scan::LogCheck& check) {
  return static_cast<double>(check.last_ns - check.first_ns) * 1e-9;
}

double rate_hz(const scan::LogCheck& check) {
  return check.median_period_s > 0.0 ? 1.0 / check.median_period_s : 0.0;
}

double degrees(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

/// The readings without an echo; empty if there are none.
std::string no_return_line(const scan::LogCheck& check) {
  std::string line;
  if (check.no_return) line = text_of(*check.no_return);
  if (check.empty_share > 0.0) {
    line += fmt::format("{}{:.1f} % of the readings are 0 or beyond the stated maximum: no echo",
                        line.empty() ? "" : "; ", 100.0 * check.empty_share);
  }
  return line.empty() ? line : line + "\n";
}

void print_faults(const std::string& path, const scan::LogCheck& check) {
  for (const scan::LogFinding& finding : check.findings) {
    std::cout << fmt::format("{}:{}: {}: {}\n", path, finding.line, describe(finding.fault),
                             finding.text);
  }
  std::cout << fmt::format("{} lines: {} scans, {} odometry, {} comments, {} others\n", check.lines,
                           check.laser_lines, check.odometry_lines, check.comments,
                           check.other_lines);
  if (check.scans > 0) {
    std::cout << fmt::format(
        "{} beams from {:.2f} deg by {:.3f} deg; {:.1f} s, {:.2f} scans a second, longest pause "
        "{:.2f} s; {:.1f} m of path\n",
        check.beams, degrees(check.angle_min_rad), degrees(check.angle_step_rad), duration_s(check),
        rate_hz(check), check.longest_period_s, check.path_m);
  }
  std::cout << no_return_line(check);
  if (check.faults() == 0) {
    std::cout << "no fault found\n";
    return;
  }
  std::cout << check.faults() << (check.faults() == 1 ? " fault" : " faults");
  const char* separator = ": ";
  for (std::size_t i = 0; i < scan::kLogFaults; ++i) {
    if (check.counts[i] == 0) continue;
    std::cout << separator << check.counts[i] << ' ' << describe(static_cast<scan::LogFault>(i));
    separator = ", ";
  }
  if (check.findings.size() < check.faults()) {
    std::cout << " (" << check.findings.size() << " shown)";
  }
  std::cout << '\n';
}

void print_faults_json(const std::string& path, const scan::LogCheck& check) {
  nlohmann::ordered_json out;
  out["log"] = path;
  out["lines"] = check.lines;
  out["laser_lines"] = check.laser_lines;
  out["scans"] = check.scans;
  out["odometry_lines"] = check.odometry_lines;
  out["comments"] = check.comments;
  out["other_lines"] = check.other_lines;
  out["beams"] = check.beams;
  out["angle_min_rad"] = check.angle_min_rad;
  out["angle_step_rad"] = check.angle_step_rad;
  out["first_stamp_ns"] = check.first_ns;
  out["last_stamp_ns"] = check.last_ns;
  out["median_period_s"] = check.median_period_s;
  out["longest_period_s"] = check.longest_period_s;
  out["way_m"] = check.path_m;
  if (check.no_return) {
    out["no_return_m"] = check.no_return->range_m;
    out["no_return_share"] = check.no_return->share;
  }
  out["empty_share"] = check.empty_share;
  out["faults"] = check.faults();
  nlohmann::ordered_json counts = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < scan::kLogFaults; ++i) {
    counts[std::string(describe(static_cast<scan::LogFault>(i)))] = check.counts[i];
  }
  out["counts"] = std::move(counts);
  nlohmann::ordered_json findings = nlohmann::ordered_json::array();
  for (const scan::LogFinding& finding : check.findings) {
    findings.push_back({{"line", finding.line},
                        {"fault", std::string(describe(finding.fault))},
                        {"text", finding.text}});
  }
  out["findings"] = std::move(findings);
  // Texts in a damaged log may be invalid UTF-8.
  std::cout << out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

struct LogRequest {
  std::string log;
  bool json = false;
  scan::LogCheckOptions options;
  recording::TopicChoice topics;
};

int check_log(const LogRequest& request) {
  scan::LogCheck check;
  try {
    check = recording::check_log(request.log, request.options, request.topics);
  } catch (const std::runtime_error& error) {
    std::cerr << "topogeo: " << error.what() << '\n';
    return kUnreadable;
  }
  if (request.json) {
    print_faults_json(request.log, check);
  } else {
    print_faults(request.log, check);
  }
  return check.faults() == 0 ? kClean : kFaulty;
}

}  // namespace

void add_check_log_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand("check-log", "List the faults of a log");
  auto request = std::make_shared<LogRequest>();
  constexpr double kMost = 1e6;
  command->add_option("log,--log", request->log, recording::kLogFormats)->required();
  add_topic_options(*command, request->topics);
  command->add_flag("--json", request->json, "print everything as JSON");
  command
      ->add_option("--gap", request->options.longest_gap_s,
                   "report longer pauses between two scans, seconds")
      ->check(command_line::range(1e-3, kMost))
      ->default_str("five times the median, at least 2");
  command
      ->add_option("--speed", request->options.largest_mps, "report faster odometry as a jump, m/s")
      ->check(command_line::range(1e-3, kMost))
      ->capture_default_str();
  command->add_option("--turn", request->options.largest_radps, "the same for rotation, rad/s")
      ->check(command_line::range(1e-3, kMost))
      ->capture_default_str();
  command
      ->add_option("--stuck", request->options.stuck_scans,
                   "report this many identical scans in a row")
      ->check(command_line::range(2U, 1'000'000U))
      ->capture_default_str();
  command
      ->add_option("--findings", request->options.findings,
                   "faults of each kind to show; all are counted")
      ->check(command_line::range(std::size_t{1}, std::size_t{1'000'000}))
      ->capture_default_str();
  command->footer("Exit codes: 0 no fault, 1 faults found, 2 not a log that can be read.");
  command->callback([request, &exit_code] { exit_code = check_log(*request); });
}

}  // namespace topogeo::cli
