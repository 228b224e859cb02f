// How often a scan is found again in a finished map without an initial pose.
//
//   topogeo_global_localization [--scans N] [--csv FILE] LOG...
//
// "same drive": the map of the whole log, searched with scans that are no stops of it. "second
// half": the map of the first half of the log, searched with scans of the second half at places
// that the first half had seen. The truth is the pose by the map of the whole log, relative to the
// nearest stop of the searched map. Right is within 0.3 m and 5 degrees.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/relocalization/global_localization.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace {

using namespace topogeo;
using geometry::Pose2;

struct Question {
  const scan::Scan* scan = nullptr;
  Pose2 T_map_robot;  // truth in the searched map
};

struct Row {
  std::size_t asked = 0;
  std::size_t right = 0;
  std::size_t accepted = 0;
  std::size_t accepted_wrong = 0;
  std::size_t among = 0;  // the truth is among the distinct poses of the answer
  std::vector<double> ms;
};

bool is_right(const Pose2& pose, const Pose2& truth) {
  constexpr double kRight_m = 0.3;
  constexpr double kRight_rad = 0.0872664626;
  return (pose.position_m() - truth.position_m()).norm() <= kRight_m &&
         std::fabs(geometry::wrap_angle(pose.theta_rad - truth.theta_rad)) <= kRight_rad;
}

storage::MapDocument map_of(const std::vector<scan::Scan>& scans, std::size_t count,
                            const pipeline::Config& config) {
  pipeline::MappingRun run(config, "robot");
  for (std::size_t i = 0; i < count; ++i) run.add(scans[i]);
  return run.finish();
}

Row ask(const storage::MapDocument& map, const std::vector<Question>& questions,
        const pipeline::Config& config, std::FILE* csv, const std::string& name) {
  const localization::GlobalLocalizer localizer(map.local_maps, map.trajectory);
  Row row;
  for (const Question& question : questions) {
    const auto points = topomap::scan_points(*question.scan, config.local_mapper.T_robot_laser,
                                             config.local_mapper.local_map.points_range_m);
    const double start_s = support::process_cpu_s();
    const localization::GlobalAnswer answer =
        localizer.find(points, config.local_mapper.T_robot_laser);
    row.ms.push_back(1e3 * (support::process_cpu_s() - start_s));
    ++row.asked;
    const bool right =
        !answer.poses.empty() && is_right(answer.poses.front().T_map_robot, question.T_map_robot);
    const bool accepted = answer.verdict == localization::Verdict::kAccepted;
    row.right += right ? 1 : 0;
    row.accepted += accepted ? 1 : 0;
    row.accepted_wrong += accepted && !right ? 1 : 0;
    const bool among = std::any_of(answer.poses.begin(), answer.poses.end(), [&](const auto& pose) {
      return is_right(pose.T_map_robot, question.T_map_robot);
    });
    row.among += among ? 1 : 0;
    if (csv == nullptr || answer.poses.empty()) continue;
    const localization::GlobalPose& best = answer.poses.front();
    std::fprintf(csv, "%s,%d,%d,%d,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f\n", name.c_str(), right,
                 accepted, among, best.fitness, answer.rivalry, best.doubt, best.inliers,
                 best.violations,
                 (best.T_map_robot.position_m() - question.T_map_robot.position_m()).norm(),
                 geometry::wrap_angle(best.T_map_robot.theta_rad - question.T_map_robot.theta_rad));
  }
  return row;
}

void print(const std::string& log, const char* kind, Row row) {
  if (row.asked == 0) return;
  std::sort(row.ms.begin(), row.ms.end());
  const auto share = [&](std::size_t n) {
    return 100.0 * static_cast<double>(n) / static_cast<double>(row.asked);
  };
  std::printf("| %s | %s | %zu | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |\n", log.c_str(), kind,
              row.asked, share(row.right), share(row.among), share(row.accepted),
              share(row.accepted_wrong), row.ms[row.ms.size() / 2],
              row.ms[row.ms.size() * 99 / 100]);
  std::fflush(stdout);
}

std::vector<Question> sample(std::vector<Question> questions, std::size_t count) {
  if (questions.size() <= count) return questions;
  std::vector<Question> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(questions[i * questions.size() / count]);
  return out;
}

void evaluate(const std::string& file, std::size_t count, const pipeline::Config& config,
              std::FILE* csv) {
  const std::string name = std::filesystem::path(file).stem().stem().string();
  scan::CarmenLogReader reader(file, config.log);
  std::vector<scan::Scan> scans;
  while (const auto scan = reader.next()) scans.push_back(*scan);
  const storage::MapDocument whole = map_of(scans, scans.size(), config);
  std::map<std::uint64_t, Pose2> truth;  // by sequence number of the scan
  for (const auto& pose : topomap::expand_trajectory(whole.trajectory, whole.local_maps)) {
    truth[pose.sequence] = pose.pose;
  }
  std::map<std::uint64_t, bool> is_stop;
  for (const topomap::LocalMap& map : whole.local_maps) is_stop[map.sequence] = true;
  std::vector<Question> same_drive;
  for (const scan::Scan& scan : scans) {
    const auto found = truth.find(scan.sequence);
    if (found == truth.end() || is_stop.contains(scan.sequence)) continue;
    same_drive.push_back({&scan, found->second});
  }
  print(name, "same drive", ask(whole, sample(same_drive, count), config, csv, name + " same"));

  const std::size_t half = scans.size() / 2;
  const storage::MapDocument first = map_of(scans, half, config);
  std::vector<Question> second_half;
  for (std::size_t i = half; i < scans.size(); ++i) {
    const auto found = truth.find(scans[i].sequence);
    if (found == truth.end()) continue;
    double nearest_m = 1.0;
    const topomap::StopPose* stop = nullptr;
    for (const topomap::StopPose& s : first.trajectory.stops) {
      const auto at = truth.find(first.local_maps[s.local_map_id].sequence);
      if (at == truth.end()) continue;
      const Pose2 T = geometry::between(at->second, found->second);
      constexpr double kSameView_rad = 0.8;
      if (T.position_m().norm() >= nearest_m || std::fabs(T.theta_rad) > kSameView_rad) continue;
      nearest_m = T.position_m().norm();
      stop = &s;
    }
    if (stop == nullptr) continue;
    const Pose2& T_full = truth.at(first.local_maps[stop->local_map_id].sequence);
    second_half.push_back(
        {&scans[i], stop->T_map_robot * geometry::between(T_full, found->second)});
  }
  print(name, "second half", ask(first, sample(second_half, count), config, csv, name + " half"));
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("How often a scan is found again in a finished map");
  std::vector<std::string> logs;
  std::size_t count = 400;
  std::string csv_file;
  app.add_option("logs", logs, "CARMEN logs")->required();
  app.add_option("--scans", count, "asked of each map at most")->capture_default_str();
  app.add_option("--csv", csv_file, "one line for each question");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    const pipeline::LoadedConfig config = pipeline::load_config({});
    std::FILE* csv = csv_file.empty() ? nullptr : std::fopen(csv_file.c_str(), "w");
    std::printf(
        "| log | scans asked | count | right %% | among the places %% | accepted %% | accepted but "
        "wrong %% | ms, median | ms, p99 |\n|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& log : logs) evaluate(log, count, config.config, csv);
    if (csv != nullptr) std::fclose(csv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_global_localization: %s\n", error.what());
    return 1;
  }
  return 0;
}
