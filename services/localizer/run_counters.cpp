#include "run_counters.hpp"

#include <chrono>
#include <cstdint>
#include <string>

#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localizer {

void set_slam_counters(const localization::Slam& slam, std::size_t loop_closures,
                       messaging::StatusPublisher& status) {
  const localization::SlamCounts counts = slam.counts();
  const auto set = [&status](const std::string& name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  set("tasks", counts.tasks);
  set("evaluations", counts.evaluations);
  for (std::size_t i = 0; i < localization::kReasons; ++i) {
    const auto reason = static_cast<localization::Reason>(i);
    const std::string name = localization::to_string(reason);
    set(reason == localization::Reason::kNone ? name : "rejected: " + name, counts.reasons[i]);
  }
  set("loop_closures", loop_closures);
  set("loop_decisions", slam.loop_decisions().size());
  set("optimizations", counts.optimizations);
  set("failed_optimizations", counts.failed_optimizations);
  set("unconfirmed_loops", counts.unconfirmed_loops);
  set("removed_loops", counts.removed_loops);
  set("steps_in_doubt", counts.steps_in_doubt);
}

void set_pool_counters(const RemotePool& pool, messaging::StatusPublisher& status) {
  const search_pool::BoardCounts& counts = pool.counts();
  const search_pool::RegistryCounts& refused = pool.registry_counts();
  const auto set = [&status](const std::string& name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  const auto set_ms = [&status](const std::string& name, search_pool::BoardTime time) {
    status.set_counter(name, std::chrono::duration<double, std::milli>(time).count());
  };
  status.set_queue("match tasks", pool.open_tasks());
  set("workers", pool.workers());
  set("workers_lost", counts.workers_lost);
  set("workers_excluded", counts.workers_excluded);
  set("workers_of_other_version", refused.other_version);
  set("workers_of_other_matcher", refused.other_matcher);
  set("workers_of_other_configuration", refused.other_configuration);
  set("workers_of_one_id", refused.shared_ids);
  set("tasks_sent", counts.sent);
  set("tasks_resent", counts.resent);
  set("tasks_redone", counts.redone);
  set("tasks_in_process", counts.in_process);
  set("tasks_failed", counts.failed);
  set("maps_missing", counts.map_missing);
  set("maps_sent", pool.maps_sent());
  set("answers_ignored", counts.ignored);
  set("audits", counts.audits);
  set("audit_differences", counts.audit_differences);
  set("duplicates", counts.duplicates);
  set("duplicate_differences", counts.duplicate_differences);
  set_ms("recovery_ms", counts.last_recovery);
  set_ms("longest_recovery_ms", counts.longest_recovery);
}

}  // namespace topogeo::localizer
