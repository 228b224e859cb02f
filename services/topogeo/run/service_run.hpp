// All services of one run as child processes in a partition of their own, with the event loop of
// the command that monitors them.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/msg/status.h"
#include "topogeo/supervision/process_group.hpp"

#include "run/restart_log.hpp"
#include "run/run_services.hpp"

namespace topogeo::cli {

class ServiceRun {
 public:
  /// All are called in the loop, except log, which is called by its users.
  struct Hooks {
    std::function<void()> on_tick;                     ///< twenty times a second
    std::function<void()> on_first_signal;             ///< empty: ends the run, like the second
    std::function<void(const std::string& line)> log;  ///< for the user
    /// Each status, also after the end of the run; empty: the caller does not need them.
    std::function<void(const msg::ServiceStatus&, const messaging::SampleInfo&)> on_status = {};
    /// The links of the page, once they exist; empty: they are logged, with the token only to a
    /// terminal.
    std::function<void(const std::string& lines, const std::string& without_token)> on_links = {};
  };

  /// Joins the domain; no service is started yet. Throws like messaging::Participant and
  /// supervision::ProcessGroup.
  explicit ServiceRun(const RunOptions& options);

  ServiceRun(const ServiceRun&) = delete;
  ServiceRun& operator=(const ServiceRun&) = delete;
  ServiceRun(ServiceRun&&) = delete;
  ServiceRun& operator=(ServiceRun&&) = delete;
  ~ServiceRun();

  [[nodiscard]] const messaging::Participant& participant() const { return participant_; }
  [[nodiscard]] messaging::EventLoop& loop() { return loop_; }

  /// Starts the services. Call it once all readers exist, because they would miss the first
  /// messages otherwise. Throws like start_services and messaging::SignalStop.
  void start(const RunOptions& options, Hooks hooks);

  /// Runs the loop until the caller, fail(), the end of a required service or a signal stops it. No
  /// hook is called afterwards.
  void run();
  /// run() has returned: the outcome of the run is decided.
  [[nodiscard]] bool ended() const { return ended_; }

  /// Ends all services except the page and starts them with other options as soon as they have
  /// ended. One that hangs is killed.
  void begin_again(const RunOptions& options);

  /// Whether a status is of a process of this run that has not been restarted since. Any
  /// participant in the domain can send one.
  [[nodiscard]] bool has_started(const msg::ServiceStatus& status) const;

  /// "this machine is too busy: the CPU is short for localizer, navigator" during that; else empty.
  [[nodiscard]] std::string too_busy() const;

  /// Asks the source of the scans to end, so that the others finish their work.
  void end_stream() { processes_.finish(source_); }

  /// Ends the run because it cannot succeed any more. The first reason is kept.
  void fail(const std::string& why);
  /// Records a failure, but lets the run continue for now.
  void note_failure(const std::string& why);
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Number of the last signal, 0 if there was none.
  [[nodiscard]] int signal_number() const { return signal_.load(); }

  /// Runs the loop until a signal, or returns at once after one; services that end are not
  /// restarted.
  void stay();

  /// Runs the loop until the process of that name has ended; false: it hangs, or a signal came.
  bool wait_for_end(const std::string& name);

  /// Stops all services while the loop runs, so that they publish their final counters. Waits for
  /// them however slow they are; another signal kills them at once. Returns their times.
  /// `source_first`: while scans may be under way.
  std::vector<support::StageTime> stop(bool source_first);

 private:
  void on_signal(int number);
  void on_status(const msg::ServiceStatus& status, const messaging::SampleInfo& info);
  /// Logs how long a restarted service was away, once it works again.
  void note_state(const msg::ServiceStatus& status);
  void note_cpu(const msg::ServiceStatus& status);
  [[nodiscard]] supervision::EndObserver end_observer();
  void tick();
  /// Passes on the links of the page once the web service has printed them.
  void look_for_links();
  void start_all(const RunOptions& options);
  void restart(const std::string& name, const std::string& description);
  /// The recorder has ended: a restarted gateway must not wait for it.
  void forget_recorder();
  /// Logs the likely reason if no status has come.
  void log_if_deaf();
  /// Removes what the services have saved for their restarts, except for one file.
  void forget_memories(const std::filesystem::path& except = {}) const;

  const std::string partition_;
  const std::string source_;  // of the scans
  const std::string host_;
  bool ended_ = false;
  bool recorder_there_ = false;
  int other_readers_ = 0;          // scan readers besides the recorder
  std::filesystem::path web_log_;  // file expected to get the links; empty: none
  std::string failure_;
  Hooks hooks_;
  std::optional<RunOptions> next_;  // options for a new start, once the others have ended
  std::atomic<int> signal_ = 0;
  std::atomic<int> signals_came_ = 0;
  std::set<std::string> short_of_cpu_;  // services of this run
  bool busy_logged_ = false;
  std::map<pid_t, std::uint64_t> reports_;  // received statuses
  RestartLog restarts_;

  messaging::Participant participant_;
  messaging::EventLoop loop_;
  messaging::Reader<msg::ServiceStatus> statuses_;
  supervision::ProcessGroup processes_;
  std::optional<messaging::SignalStop> signals_;  // last: its thread uses the others
};

}  // namespace topogeo::cli
