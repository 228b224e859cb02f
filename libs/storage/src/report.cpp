#include "topogeo/storage/report.hpp"

#include <stdexcept>

#include <nlohmann/json.hpp>

#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/json_limits.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::storage {
namespace {

using Json = nlohmann::ordered_json;

Json counts(const ReasonCounts& reasons) {
  Json json = Json::object();
  for (const auto& [reason, count] : reasons) json[reason] = count;
  return json;
}

Json configuration(const support::EffectiveConfig& config) {
  Json values = Json::object();
  for (const auto& [key, value] : config.values) values[key] = value;
  // Sixteen hexadecimal digits: JSON readers often store numbers as doubles, which would round it.
  return {{"fingerprint", fmt::format("{:016x}", config.fingerprint)}, {"values", values}};
}

Json loop_closures(const std::vector<topomap::LoopClosure>& closures) {
  Json json = Json::array();
  for (const topomap::LoopClosure& c : closures) {
    json.push_back({{"earlier_stop", c.earlier_id},
                    {"later_stop", c.later_id},
                    {"x_m", c.T_earlier_later.x_m},
                    {"y_m", c.T_earlier_later.y_m},
                    {"theta_rad", c.T_earlier_later.theta_rad}});
  }
  return json;
}

Json loop_candidates(const std::vector<LoopCandidate>& candidates) {
  Json json = Json::array();
  for (const LoopCandidate& c : candidates) {
    json.push_back({{"decided_at_stop", c.step},
                    {"earlier_stop", c.earlier_id},
                    {"later_stop", c.later_id},
                    {"outcome", c.outcome},
                    {"match", c.reason},
                    {"x_m", c.T_earlier_later.x_m},
                    {"y_m", c.T_earlier_later.y_m},
                    {"theta_rad", c.T_earlier_later.theta_rad},
                    {"correction_m", c.correction_m},
                    {"correction_rad", c.correction_rad},
                    {"fitness", c.fitness},
                    {"source", c.source},
                    {"predicted_x_m", c.T_predicted.x_m},
                    {"predicted_y_m", c.T_predicted.y_m},
                    {"predicted_theta_rad", c.T_predicted.theta_rad},
                    {"predicted_sigma_m", c.predicted_sigma_m},
                    {"predicted_sigma_rad", c.predicted_sigma_rad},
                    {"probability", c.probability}});
  }
  return json;
}

Json overlap_solution(const OverlapSolution& s) {
  return {{"x_m", s.T_earlier_stop.x_m},
          {"y_m", s.T_earlier_stop.y_m},
          {"theta_rad", s.T_earlier_stop.theta_rad},
          {"fitness", s.fitness},
          {"scan_fitness", s.scan},
          {"topological_fitness", s.topological},
          {"prior", s.prior}};
}

Json overlap_search(const OverlapSearch& search) {
  Json solutions = Json::array();
  for (const OverlapSolution& solution : search.solutions) {
    solutions.push_back(overlap_solution(solution));
  }
  Json refined = nullptr;
  if (search.refined.fitness > 0.0) refined = overlap_solution(search.refined);
  return {{"earlier_stop", search.earlier_id},
          {"predicted_x_m", search.T_predicted.x_m},
          {"predicted_y_m", search.T_predicted.y_m},
          {"predicted_theta_rad", search.T_predicted.theta_rad},
          {"solutions", solutions},
          {"refined", refined},
          {"verdict", search.verdict},
          {"reason", search.reason}};
}

Json overlaps(const std::vector<Overlaps>& stops) {
  Json json = Json::array();
  for (const Overlaps& of_stop : stops) {
    Json searches = Json::array();
    for (const OverlapSearch& search : of_stop.searches) {
      searches.push_back(overlap_search(search));
    }
    json.push_back(
        {{"stop", of_stop.stop_id}, {"overlap_set", of_stop.overlap_set}, {"searches", searches}});
  }
  return json;
}

Json odometry_stretches(const std::vector<OdometryStretchEntry>& stretches) {
  Json json = Json::array();
  for (const OdometryStretchEntry& s : stretches) {
    json.push_back({{"first_stop", s.first_stop},
                    {"last_stop", s.last_stop},
                    {"x_m", s.x_m},
                    {"y_m", s.y_m},
                    {"length_m", s.length_m},
                    {"off_m", s.off_m},
                    {"off_rad", s.off_rad},
                    {"held_by_loop", s.held_by_loop}});
  }
  return json;
}

Json quality(const QualityEntry& quality) {
  Json disagreements = Json::array();
  for (const PathDisagreementEntry& d : quality.path_disagreements) {
    disagreements.push_back({{"kind", d.kind},
                             {"first_stop", d.first_stop},
                             {"last_stop", d.last_stop},
                             {"odometry_m", d.odometry_m},
                             {"corrected_m", d.corrected_m},
                             {"turn_rad", d.turn_rad}});
  }
  return {{"grade", quality.grade},
          {"reasons", quality.reasons},
          {"advice", quality.advice},
          {"odometry_stretches", odometry_stretches(quality.odometry_stretches)},
          {"path_disagreements", disagreements}};
}

Json found_laser(const FoundLaserEntry& laser) {
  return {{"x_m", laser.T_robot_laser.x_m},
          {"y_m", laser.T_robot_laser.y_m},
          {"yaw_rad", laser.T_robot_laser.theta_rad},
          {"upside_down", laser.upside_down},
          {"heading_known", laser.heading_known},
          {"position_known", laser.position_known},
          {"heading_spread_rad", laser.heading_spread_rad},
          {"position_spread_m", laser.position_spread_m},
          {"confidence", laser.confidence},
          {"motions", laser.motions},
          {"fitting", laser.fitting}};
}

geometry::Pose2 pose_of(const nlohmann::json& json, const std::string& prefix) {
  return {json.at(prefix + "x_m").get<double>(), json.at(prefix + "y_m").get<double>(),
          json.at(prefix + "theta_rad").get<double>()};
}

LoopCandidate loop_candidate(const nlohmann::json& json) {
  LoopCandidate c;
  json.at("decided_at_stop").get_to(c.step);
  json.at("earlier_stop").get_to(c.earlier_id);
  json.at("later_stop").get_to(c.later_id);
  json.at("outcome").get_to(c.outcome);
  json.at("match").get_to(c.reason);
  c.T_earlier_later = pose_of(json, "");
  json.at("correction_m").get_to(c.correction_m);
  json.at("correction_rad").get_to(c.correction_rad);
  json.at("fitness").get_to(c.fitness);
  json.at("source").get_to(c.source);
  c.T_predicted = pose_of(json, "predicted_");
  json.at("predicted_sigma_m").get_to(c.predicted_sigma_m);
  json.at("predicted_sigma_rad").get_to(c.predicted_sigma_rad);
  json.at("probability").get_to(c.probability);
  return c;
}

Json stages(const std::vector<support::StageTime>& times) {
  Json json = Json::object();
  for (const support::StageTime& t : times) {
    json[t.stage] = {{"wall_s", t.wall_s}, {"cpu_s", t.cpu_s}};
  }
  return json;
}

}  // namespace

std::string report_json(const Report& report) {
  Json json;
  json["version"] = support::kVersion;
  json["command"] = report.command;
  json["log"] = std::filesystem::path(report.log).filename().string();
  json["robot_id"] = report.robot_id;
  json["seed"] = report.seed;
  json["workers"] = report.workers;
  json["counts"] = {{"scans", report.scans},
                    {"skipped_lines", counts(report.skipped_lines)},
                    {"stops", report.stops},
                    {"nodes", report.nodes},
                    {"branches", report.branches},
                    {"matches_tried", report.matches_tried},
                    {"matches_accepted", report.matches_accepted},
                    {"matches_rejected", counts(report.matches_rejected)},
                    {"loop_closures", report.loop_closures.size()},
                    {"loop_candidates", report.loop_candidates.size()}};
  if (!report.localization.empty()) json["localization"] = counts(report.localization);
  if (!report.continuation.empty()) json["continuation"] = counts(report.continuation);
  if (report.laser_odometry) {
    json["laser_odometry"] = {{"unplaced_scans", report.laser_odometry->unplaced},
                              {"breaks", report.laser_odometry->breaks},
                              {"step_m", report.laser_odometry->step_m}};
  }
  json["distance_m"] = report.distance_m;
  if (!report.quality.grade.empty()) json["quality"] = quality(report.quality);
  if (report.laser.searched) json["laser_found"] = found_laser(report.laser);
  json["wall_s"] = report.wall_s;
  json["cpu_s"] = report.cpu_s;
  json["stages"] = stages(report.stages);
  json["loop_closures"] = loop_closures(report.loop_closures);
  json["loop_candidates"] = loop_candidates(report.loop_candidates);
  if (!report.overlaps.empty()) json["overlaps"] = overlaps(report.overlaps);
  json["configuration"] = configuration(report.configuration);
  // A file name may be invalid UTF-8: invalid bytes are replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<LoopCandidate> read_loop_candidates(const std::filesystem::path& path) {
  const std::string text = support::foreign_content(path, support::kMostMapBytes);
  // Reports are long, and have more settings than other objects.
  const support::JsonLimits limits{.keys = text.size(), .values = text.size()};
  if (const std::string excess = support::beyond_limits(text, limits); !excess.empty()) {
    throw std::runtime_error(path.string() + ": " + excess);
  }
  std::string place = "the report";
  try {
    const auto report = nlohmann::json::parse(text);
    std::vector<LoopCandidate> candidates;
    for (const nlohmann::json& json : report.at("loop_candidates")) {
      place = fmt::format("loop_candidates[{}]", candidates.size());
      candidates.push_back(loop_candidate(json));
    }
    return candidates;
  } catch (const Json::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}: {}", path.string(), place, error.what()));
  }
}

void write_report(const std::filesystem::path& path, const Report& report) {
  support::write_file_atomically(path, report_json(report));
}

}  // namespace topogeo::storage
