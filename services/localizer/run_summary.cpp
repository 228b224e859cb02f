#include "run_summary.hpp"

#include <chrono>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/localization_run.hpp"

namespace topogeo::localizer {

namespace {

void add_matches(msg::RunSummary& summary, const localization::SlamCounts& counts) {
  summary.matches_tried(counts.tasks);
  summary.matches_accepted(counts.reasons[0]);
  for (std::size_t i = 1; i < localization::kReasons; ++i) {
    msg::ReasonCount count;
    count.reason(static_cast<msg::MatchReason>(i));
    count.matches(counts.reasons.at(i));
    summary.matches_rejected().push_back(count);
  }
}

void add_localization(msg::RunSummary& summary, const localization::MapTracker& tracker) {
  const auto& stops = tracker.stops_by_state();
  for (std::size_t i = 0; i < stops.size(); ++i) {
    msg::StateCount count;
    count.state(static_cast<msg::LocalizationState>(i));
    count.stops(stops.at(i));
    summary.stops_by_state().push_back(count);
  }
  summary.searches(tracker.searches());
}

void add_continuation(msg::RunSummary& summary, const localization::MappingSession& session) {
  summary.stored_stops(session.stored_stops());
  summary.added_stops(session.added_stops());
  summary.unmapped_stops(session.unmapped_stops());
  messaging::set_text_cut(summary.message(), pipeline::continuation_message(session));
}

void add_pool(msg::RunSummary& summary, const search_pool::BoardCounts& counts) {
  summary.tasks_in_process(counts.in_process);
  summary.tasks_sent(counts.sent);
  summary.tasks_resent(counts.resent);
  summary.workers_lost(counts.workers_lost);
  summary.longest_recovery_ms(
      std::chrono::duration<double, std::milli>(counts.longest_recovery).count());
}

}  // namespace

msg::RunSummary make_run_summary(const RunParts& parts, const std::string& robot_id,
                                 std::int64_t stamp_ns) {
  msg::RunSummary summary;
  messaging::set_header(summary, robot_id, stamp_ns, 0);
  add_matches(summary, parts.slam.counts());
  summary.loop_decisions(parts.slam.loop_decisions().size());
  if (parts.in_map != nullptr) add_localization(summary, *parts.in_map);
  if (parts.continued != nullptr) add_continuation(summary, *parts.continued);
  add_pool(summary, parts.pool);
  return summary;
}

}  // namespace topogeo::localizer
