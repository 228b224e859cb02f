#include "topogeo/storage/report.hpp"

#include <nlohmann/json.hpp>

#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"
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
  // Sixteen hexadecimal digits: JSON readers often keep numbers as doubles, which would round it.
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
                    {"fitness", c.fitness}});
  }
  return json;
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
  json["distance_m"] = report.distance_m;
  json["wall_s"] = report.wall_s;
  json["cpu_s"] = report.cpu_s;
  json["stages"] = stages(report.stages);
  json["loop_closures"] = loop_closures(report.loop_closures);
  json["loop_candidates"] = loop_candidates(report.loop_candidates);
  json["configuration"] = configuration(report.configuration);
  // A file name need not be valid UTF-8: what is not is replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_report(const std::filesystem::path& path, const Report& report) {
  support::write_file_atomically(path, report_json(report));
}

}  // namespace topogeo::storage
