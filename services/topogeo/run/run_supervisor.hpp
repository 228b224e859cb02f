// One run of all services on a log: starts them, monitors them to the end of the log, stops them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/status.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/decision_assembly.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/supervision/stall_watch.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/progress_bar.hpp"

#include "common/service_table.hpp"
#include "navigate/explore_session.hpp"
#include "run/service_run.hpp"
#include "run/tour_driver.hpp"

namespace topogeo::cli {

struct RunResult {
  bool finished = false;                  ///< the map is written
  int signal_number = 0;                  ///< signal that stopped the run, else 0
  double stayed_s = 0.0;                  ///< how long the page stayed after the end
  std::string failure;                    ///< why it did not finish, unless a signal stopped it
  std::vector<support::StageTime> times;  ///< per service
  ServiceTable services;                  ///< last statuses
  msg::RunSummary summary;                ///< of the localizer, when finished
  std::vector<localization::LoopDecision> loop_decisions;  ///< all, when finished
  // For a simulation:
  std::vector<topomap::StampedPose> truth;  ///< true poses of the robot
  std::uint64_t collisions = 0;
};

class RunSupervisor {
 public:
  /// Starts the services, in a partition of their own. `laser_lines`: largest number of scans to
  /// come. Throws like ServiceRun. The world of a simulation has a tour. A run on devices ends with
  /// the tour, or with the first signal; the map of everything seen by then is finished. With a
  /// page, the services of a finished run stay until a signal.
  RunSupervisor(const RunOptions& options, std::uint64_t laser_lines);

  /// Returns when all services have ended. Call it once.
  RunResult run();

 private:
  void tick();
  void watch_tour();
  void watch_exploration();
  void end_stream();
  void check_states();
  void check_stall();
  void show_progress();
  void finish_bar();
  void print(const std::string& text);
  void wait_for_summary();
  void wait_for_recorder();
  void stay_for_page();

  RunOptions options_;
  std::uint64_t laser_lines_;
  double start_s_;
  RunResult result_;
  bool bar_done_ = false;
  support::ProgressBar bar_;
  supervision::StallWatch stall_;
  service::DecisionAssembly decisions_;
  bool summary_came_ = false;

  ServiceRun run_;
  messaging::Reader<msg::StreamEnd> end_reader_;
  messaging::Reader<msg::LoopDecisions> decision_reader_;
  messaging::Reader<msg::RunSummary> summary_reader_;
  std::optional<TourDriver> tour_;  // during exploration it only records the truth
  std::optional<ExploreSession> exploration_;
  bool stream_ended_ = false;  // the gateway was asked to end
};

}  // namespace topogeo::cli
