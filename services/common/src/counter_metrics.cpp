#include <algorithm>
#include <array>

#include "topogeo/service/status_metrics.hpp"

namespace topogeo::service {
namespace {

using enum MetricKind;

constexpr double kMilli = 1e-3;
constexpr double kPercent = 1e-2;

constexpr auto kCounterMetrics = std::to_array<CounterMetric>({
    // every service
    {"cpu_s", "topogeo_cpu_seconds_total", kTotal, "CPU time of the process"},
    {"cpu_wait_ratio", "topogeo_cpu_wait_ratio", kGauge,
     "threads that wait for a CPU, on average over a second"},
    {"timer_delay_s", "topogeo_timer_delay_seconds", kGauge,
     "largest delay of a timer in the last second"},
    {"cpu_short", "topogeo_cpu_short", kGauge, "1 while the service gets too little CPU time"},
    {"deaf", "topogeo_deaf", kGauge, "1 while the main input is published but does not arrive"},
    {"resident_bytes", "topogeo_resident_memory_bytes", kGauge, "memory in use"},
    {"open_files", "topogeo_open_fds", kGauge, "open files and sockets"},
    // sensor gateway
    {"scans_sent", "topogeo_scans_sent_total", kTotal, "scans published"},
    {"scans_total", "topogeo_log_scans", kGauge, "scans in the log that is replayed"},
    {"scans_with_extrapolated_odometry", "topogeo_extrapolated_scans_total", kTotal,
     "scans newer than the odometry they were given"},
    {"beams", "topogeo_scan_beams", kGauge, "beams of a scan"},
    {"delayed_s", "topogeo_replay_delay_seconds_total", kTotal,
     "time the replay waited for readers"},
    {"laser_baud", "topogeo_laser_line_bauds", kGauge, "baud rate of the laser's line"},
    {"laser_port_opened", "topogeo_port_openings_total", kTotal, "times a port was opened",
     "device=laser"},
    {"base_port_opened", "topogeo_port_openings_total", kTotal, "times a port was opened",
     "device=base"},
    {"laser_searches", "topogeo_laser_searches_total", kTotal, "searches for the laser's rate"},
    {"scan_latency_ms", "topogeo_scan_latency_seconds", kGauge,
     "from the last byte of a scan to its publication", "", kMilli},
    {"scan_latency_largest_ms", "topogeo_scan_latency_largest_seconds", kGauge,
     "largest latency since the start", "", kMilli},
    {"scan_wait_ms", "topogeo_scan_wait_seconds", kGauge, "a scan's wait for odometry of its time",
     "", kMilli},
    {"odometry_sent", "topogeo_odometry_sent_total", kTotal, "odometry messages published"},
    {"motion_commands", "topogeo_motion_commands_total", kTotal, "motion commands of clients",
     "result=taken"},
    {"motion_commands_refused", "topogeo_motion_commands_total", kTotal,
     "motion commands of clients", "result=refused"},
    {"last_guard_stops", "topogeo_last_guard_stops_total", kTotal,
     "commanded motions that the gateway stopped"},
    {"too_tight_turns", "topogeo_too_tight_turns_total", kTotal,
     "commanded turns below the turning radius of the base"},
    {"base_starts", "topogeo_base_starts_total", kTotal, "times the base was started"},
    {"base_restarts", "topogeo_base_restarts_total", kTotal, "times the base restarted by itself"},
    {"base_watchdog_expirations", "topogeo_base_watchdog_expirations_total", kTotal,
     "times the base stopped because no command came"},
    {"battery_percent", "topogeo_battery_charge_ratio", kGauge,
     "charge of the battery as the base measures it", "", kPercent},
    // local mapper
    {"scans", "topogeo_scans_total", kTotal, "scans processed"},
    {"local_maps", "topogeo_local_maps", kGauge, "local maps made, received or held"},
    {"local_maps_kept", "topogeo_local_maps_kept", kGauge, "local maps kept for late readers"},
    {"tracked_scans", "topogeo_tracked_scans_total", kTotal, "scans between stops"},
    {"matched_scans", "topogeo_matched_scans_total", kTotal,
     "scans between stops whose pose is that of a match"},
    // localizer
    {"stops", "topogeo_stops", kGauge, "stops of the drive"},
    {"stops_in_map", "topogeo_map_stops", kGauge, "stops of the map"},
    {"stored_stops", "topogeo_stored_stops", kGauge, "stops of the map that is extended"},
    {"added_stops", "topogeo_added_stops", kGauge, "stops added to the map that is extended"},
    {"unmapped_stops", "topogeo_unmapped_stops", kGauge,
     "stops that are not placed in the extended map yet"},
    {"tasks", "topogeo_match_tasks_total", kTotal, "match tasks made"},
    {"evaluations", "topogeo_match_evaluations_total", kTotal, "fitness values computed"},
    {"accepted", "topogeo_matches_total", kTotal, "matches by decision of the gate",
     "result=accepted"},
    {"rejected: *", "topogeo_matches_total", kTotal, "matches by decision of the gate", "result"},
    {"loop_closures", "topogeo_loop_closures", kGauge, "loops closed in the trajectory"},
    {"loop_decisions", "topogeo_loop_decisions", kGauge, "decisions about loops"},
    {"optimizations", "topogeo_optimizations_total", kTotal, "corrections of all poses"},
    {"failed_optimizations", "topogeo_failed_optimizations_total", kTotal,
     "corrections that did not converge"},
    {"unconfirmed_loops", "topogeo_unconfirmed_loops_total", kTotal,
     "loop hypotheses that were given up"},
    {"removed_loops", "topogeo_removed_loops_total", kTotal,
     "loop closures that were removed again"},
    {"steps_in_doubt", "topogeo_steps_in_doubt_total", kTotal, "stops without an accepted match"},
    {"TRACKING", "topogeo_localized_stops", kGauge, "stops by the state of localization",
     "state=tracking"},
    {"AMBIGUOUS", "topogeo_localized_stops", kGauge, "stops by the state of localization",
     "state=ambiguous"},
    {"SEARCHING", "topogeo_localized_stops", kGauge, "stops by the state of localization",
     "state=searching"},
    {"LOST", "topogeo_localized_stops", kGauge, "stops by the state of localization", "state=lost"},
    {"searches", "topogeo_map_searches_total", kTotal, "searches of the whole map"},
    {"commands_accepted", "topogeo_commands_total", kTotal, "commands of operators",
     "result=accepted"},
    {"commands_refused", "topogeo_commands_total", kTotal, "commands of operators",
     "result=refused"},
    // search pool, as its client sees it
    {"workers", "topogeo_pool_workers", kGauge, "search workers in use"},
    {"workers_lost", "topogeo_pool_workers_lost_total", kTotal, "workers lost with tasks in hand"},
    {"workers_excluded", "topogeo_pool_workers_excluded_total", kTotal, "workers excluded"},
    {"workers_of_other_version", "topogeo_pool_workers_refused", kGauge, "workers not used",
     "reason=version"},
    {"workers_of_other_matcher", "topogeo_pool_workers_refused", kGauge, "workers not used",
     "reason=matcher"},
    {"workers_of_other_configuration", "topogeo_pool_workers_refused", kGauge, "workers not used",
     "reason=configuration"},
    {"workers_of_one_id", "topogeo_pool_workers_refused", kGauge, "workers not used",
     "reason=same id"},
    {"tasks_sent", "topogeo_pool_tasks_sent_total", kTotal, "tasks sent to workers"},
    {"tasks_resent", "topogeo_pool_tasks_resent_total", kTotal, "tasks sent once more"},
    {"tasks_redone", "topogeo_pool_tasks_redone_total", kTotal,
     "tasks of lost workers solved again"},
    {"tasks_in_process", "topogeo_pool_tasks_in_process_total", kTotal,
     "tasks solved by the localizer itself"},
    {"tasks_failed", "topogeo_pool_tasks_failed_total", kTotal, "tasks a worker could not solve"},
    {"maps_missing", "topogeo_pool_maps_missing_total", kTotal,
     "tasks refused because a local map was missing"},
    {"maps_sent", "topogeo_pool_maps_sent_total", kTotal, "local maps sent to workers"},
    {"answers_ignored", "topogeo_pool_answers_ignored_total", kTotal, "answers ignored"},
    {"audits", "topogeo_pool_audits_total", kTotal, "answers checked by an own search"},
    {"audit_differences", "topogeo_pool_audit_differences_total", kTotal,
     "wrong answers found by own searches"},
    {"duplicates", "topogeo_pool_duplicates_total", kTotal, "second answers to a task"},
    {"duplicate_differences", "topogeo_pool_duplicate_differences_total", kTotal,
     "second answers that differed"},
    {"recovery_ms", "topogeo_pool_recovery_seconds", kGauge,
     "time from the last loss of a worker to the answers of others", "", kMilli},
    {"longest_recovery_ms", "topogeo_pool_recovery_longest_seconds", kGauge,
     "longest time from the loss of a worker to the answers of others", "", kMilli},
    // search worker
    {"slots", "topogeo_worker_slots", kGauge, "tasks that can be solved in parallel"},
    {"busy_slots", "topogeo_worker_busy_slots", kGauge, "slots busy since the last status"},
    {"tasks_done", "topogeo_worker_tasks_total", kTotal, "tasks by result", "result=answered"},
    {"failures", "topogeo_worker_tasks_total", kTotal, "tasks by result",
     "result=refused or failed"},
    {"clients", "topogeo_worker_clients", kGauge, "robots served over the last seconds"},
    {"maps_held", "topogeo_worker_maps", kGauge, "local maps in memory"},
    {"maps_dropped", "topogeo_worker_maps_evicted_total", kTotal, "local maps evicted from memory"},
    {"maps_requested", "topogeo_worker_maps_requested_total", kTotal, "local maps requested"},
    // map store
    {"trajectory_version", "topogeo_trajectory_version", kGauge,
     "version of the trajectory in the map"},
    {"stored_local_maps", "topogeo_stored_local_maps", kGauge, "local maps in the database"},
    {"snapshots_served", "topogeo_snapshots_total", kTotal, "copies of the map asked for",
     "result=served"},
    {"snapshots_refused", "topogeo_snapshots_total", kTotal, "copies of the map asked for",
     "result=refused"},
    {"map_rebuilds", "topogeo_map_rebuilds_total", kTotal, "times the map was rebuilt"},
    {"map_updates", "topogeo_map_updates_total", kTotal, "versions of the map published"},
    {"map_elements_sent", "topogeo_map_elements_sent_total", kTotal, "nodes and branches sent"},
    {"map_nodes", "topogeo_map_nodes", kGauge, "nodes of the map"},
    {"map_branches", "topogeo_map_branches", kGauge, "branches of the map"},
    {"map_zones", "topogeo_map_zones", kGauge, "zones of the map"},
    {"map_version", "topogeo_map_version", kGauge, "version of the hybrid map in use"},
    {"hybrid_zones", "topogeo_hybrid_zones", kGauge, "zones of the hybrid map"},
    {"hybrid_nodes", "topogeo_hybrid_nodes", kGauge, "border nodes of the hybrid map"},
    {"hybrid_updates", "topogeo_hybrid_updates_total", kTotal, "versions of the hybrid map"},
    {"grid_tiles_sent", "topogeo_grid_tiles_sent_total", kTotal, "tiles of the grid sent"},
    {"places", "topogeo_places", kGauge, "named places of the map"},
    // planner and navigator
    {"goals", "topogeo_goals_total", kTotal, "goals taken"},
    {"routes_found", "topogeo_routes_total", kTotal, "answers to goals", "result=found"},
    {"routes_on_branches", "topogeo_routes_on_branches_total", kTotal,
     "routes found along branches of the topo-geometric map"},
    {"routes_refused", "topogeo_routes_total", kTotal, "answers to goals", "result=refused"},
    {"routes", "topogeo_routes_taken_total", kTotal, "routes that were followed"},
    {"arrivals", "topogeo_arrivals_total", kTotal, "goals that were reached"},
    {"commands", "topogeo_velocities_sent_total", kTotal, "velocities sent to the base"},
    // bridge to ROS 2
    {"scans_adapted", "topogeo_ros_adapted_scans_total", kTotal,
     "ROS scans resampled to the beams of the first one"},
    {"poses_sent", "topogeo_ros_poses_sent_total", kTotal, "poses published on ROS"},
    {"ros_maps_sent", "topogeo_ros_maps_sent_total", kTotal, "whole maps published on ROS"},
    {"map_updates_sent", "topogeo_ros_map_updates_sent_total", kTotal,
     "parts of the map published on ROS"},
    {"initial_poses", "topogeo_ros_initial_poses_total", kTotal, "poses set from ROS"},
    {"velocities", "topogeo_ros_velocities_total", kTotal, "velocities exchanged with ROS"},
    // web
    {"viewers", "topogeo_web_viewers", kGauge, "pages connected"},
    {"requests", "topogeo_web_requests_total", kTotal, "requests by HTTP"},
    {"orders", "topogeo_web_orders_total", kTotal, "orders of the operator"},
    {"messages_sent", "topogeo_web_messages_total", kTotal, "messages to pages"},
    {"bytes_sent", "topogeo_web_sent_bytes_total", kTotal, "bytes sent to pages"},
    // simulator
    {"time_s", "topogeo_simulated_seconds_total", kTotal, "time in the simulated world"},
    {"stood_still_s", "topogeo_simulator_delay_seconds_total", kTotal,
     "time the simulator was late"},
    {"way_m", "topogeo_simulated_path_meters_total", kTotal, "distance the robot has driven"},
    {"collisions", "topogeo_simulated_collisions_total", kTotal, "collisions of the robot"},
    {"run_into", "topogeo_simulated_bumps_total", kTotal, "times people ran into the robot"},
    {"laser_scans", "topogeo_simulated_scans_total", kTotal, "scans the simulated laser has sent"},
    {"base_reports", "topogeo_simulated_base_reports_total", kTotal,
     "reports the simulated base has sent"},
    {"bytes_lost", "topogeo_simulated_lost_bytes_total", kTotal, "bytes that no program read"},
    {"faults_made", "topogeo_simulated_faults_total", kTotal, "faults made on purpose"},
});

bool matches(const CounterMetric& metric, std::string_view counter) {
  if (!metric.counter.ends_with('*')) return metric.counter == counter;
  return counter.starts_with(metric.counter.substr(0, metric.counter.size() - 1));
}

}  // namespace

std::span<const CounterMetric> counter_metrics() {
  return kCounterMetrics;
}

const CounterMetric* find_metric(std::string_view counter) {
  const auto found = std::ranges::find_if(
      kCounterMetrics, [&](const CounterMetric& metric) { return matches(metric, counter); });
  return found == kCounterMetrics.end() ? nullptr : &*found;
}

}  // namespace topogeo::service
