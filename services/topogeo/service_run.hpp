// All services of one run as child processes in a partition of their own, and the event loop of the
// command that watches them.
#pragma once

#include <atomic>
#include <cstdint>
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

#include "restart_log.hpp"
#include "run_services.hpp"

namespace topogeo::cli {

class ServiceRun {
 public:
  /// All are called in the loop, but log from where it is needed.
  struct Hooks {
    std::function<void()> on_tick;                     ///< twenty times a second
    std::function<void()> on_first_signal;             ///< empty: it ends the run like the second
    std::function<void(const std::string& line)> log;  ///< for the user
    /// Each status that comes, after the run has ended, too; empty: nothing else needs them.
    std::function<void(const msg::ServiceStatus&, const messaging::SampleInfo&)> on_status = {};
    /// The links of the page, once there are any; empty: they are logged, with the token to a
    /// terminal alone.
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

  /// Starts the services. Call it when all readers are there, or they miss what the services
  /// publish first. Throws like start_services and messaging::SignalStop.
  void start(const RunOptions& options, Hooks hooks);

  /// Runs the loop until it is stopped: by the caller, by fail(), by a service that ended although
  /// it is needed, or by a signal. No hook is called afterwards.
  void run();
  /// run() has returned: how the run ends has been decided.
  [[nodiscard]] bool ended() const { return ended_; }

  /// Ends all services but the page and starts them with other options; at once when they have
  /// ended. One that hangs is killed.
  void begin_again(const RunOptions& options);

  /// Whether a status is of a process of this run that has not been started again since. Anybody
  /// in the domain can send one.
  [[nodiscard]] bool has_started(const msg::ServiceStatus& status) const;

  /// "this machine is too busy: the CPU is short for localizer, navigator" while it is; else empty.
  [[nodiscard]] std::string too_busy() const;

  /// Asks the source of the scans to end, so that the others finish their work.
  void end_stream() { processes_.finish(source_); }

  /// The run cannot succeed any more, and ends. The first reason stays.
  void fail(const std::string& why);
  /// The same, but the run goes on for now.
  void note_failure(const std::string& why);
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Number of the last signal that came, 0 if none has.
  [[nodiscard]] int signal_number() const { return signal_.load(); }

  /// Runs the loop until a signal comes, at once if one has come; services that end are not started
  /// again.
  void stay();

  /// Runs the loop until the process of that name has ended; false: it hangs, or a signal came.
  bool wait_for_end(const std::string& name);

  /// Stops all services while the loop goes on: they publish their final counters. Waits for them
  /// however slow they are; another signal kills them at once. Returns their times.
  /// `source_first`: while scans may be on their way.
  std::vector<support::StageTime> stop(bool source_first);

 private:
  void on_signal(int number);
  void on_status(const msg::ServiceStatus& status, const messaging::SampleInfo& info);
  /// Logs how long a service was away that was started again and is at work.
  void note_state(const msg::ServiceStatus& status);
  void note_cpu(const msg::ServiceStatus& status);
  [[nodiscard]] supervision::EndObserver end_observer();
  void tick();
  /// Passes the links of the page on when the web service has printed them.
  void look_for_links();
  void start_all(const RunOptions& options);
  void restart(const std::string& name, const std::string& description);
  /// The recorder has ended: a gateway that is started again is not to wait for it.
  void forget_recorder();
  void forget_memories() const;

  const std::string partition_;
  const std::string source_;  // of the scans
  const std::string host_;
  bool ended_ = false;
  bool recorder_there_ = false;
  int other_readers_ = 0;          // of scans than the recorder
  std::filesystem::path web_log_;  // where the links are to come; empty: nowhere
  std::string failure_;
  Hooks hooks_;
  std::optional<RunOptions> next_;  // to begin again with, once the others have ended
  std::atomic<int> signal_ = 0;
  std::atomic<int> signals_came_ = 0;
  std::set<std::string> short_of_cpu_;  // services of this run
  bool busy_logged_ = false;
  std::map<pid_t, std::uint64_t> reports_;  // statuses that came
  RestartLog restarts_;

  messaging::Participant participant_;
  messaging::EventLoop loop_;
  messaging::Reader<msg::ServiceStatus> statuses_;
  supervision::ProcessGroup processes_;
  std::optional<messaging::SignalStop> signals_;  // last: its thread uses the others
};

}  // namespace topogeo::cli
