// A run of the real services in which the test plays the sensor gateway: it controls the progress
// of the run, so that events happen in the middle of it on a machine of any speed.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/scan/scan.hpp"

#include "program.hpp"
#include "waiting.hpp"

namespace topogeo::test {

inline const std::chrono::seconds kFaultPatience = hang_limit();

/// The first part of a drive through the simulated floor, up to one return to a known place.
class Drive {
 public:
  /// Writes the log and maps it with `topogeo map`.
  explicit Drive(const Scratch& scratch);

  [[nodiscard]] const std::vector<scan::Scan>& scans() const { return scans_; }
  [[nodiscard]] const std::string& log() const { return log_; }
  /// A result file of one process.
  [[nodiscard]] std::string expected(const std::string& file) const;
  /// Number of matches that one process has tried.
  [[nodiscard]] double expected_tasks() const;
  /// Number of stops that one process makes of so many scans.
  [[nodiscard]] std::size_t stops_of(std::size_t scans) const;

 private:
  std::string log_;
  std::filesystem::path out_;
  std::vector<scan::Scan> scans_;
  std::vector<std::uint64_t> stop_scans_;  // numbers of the scans taken at a stop
};

/// map_store, local_mapper and localizer in a partition of their own.
class ServiceRun {
 public:
  using Condition = std::function<bool()>;

  /// `name` names the directory of the results.
  ServiceRun(const Scratch& scratch, const Drive& drive, const std::string& name);
  ServiceRun(const ServiceRun&) = delete;
  ServiceRun& operator=(const ServiceRun&) = delete;
  /// Asks the services to end.
  ~ServiceRun();

  /// Flags for programs that take part.
  [[nodiscard]] std::vector<std::string> flags() const;
  /// Starts a ga_worker for this run.
  Program& start_worker(const std::string& name);

  /// Sends scans until `condition` holds. False when it does not within the hang limit. The
  /// localizer always has some stops to work on, and never many.
  bool go_on_until(const Condition& condition);
  /// Continues until so many stops are localized.
  bool go_on_until_stop(std::size_t stop);
  /// Sends the rest and waits for the results.
  bool finish();
  /// Sends scans (if the localizer has little left to do) and receives messages.
  void step();

  // These do not send scans.
  bool wait_until(const Condition& condition);
  bool wait_for_workers(std::size_t count);
  /// Waits until the localizer has no work left.
  bool wait_until_idle();

  /// Stops localized so far.
  [[nodiscard]] std::size_t stops() const { return stops_; }
  /// A counter of the localizer; -1: not published yet.
  [[nodiscard]] double counter(const std::string& name) const;
  /// Number of the localizer's faults with this reason.
  [[nodiscard]] std::uint64_t faults(const std::string& reason) const;
  [[nodiscard]] bool has_ended() const { return ended_; }
  /// The localizer's log.
  [[nodiscard]] std::string log() const { return localizer_->err(); }
  /// Status of the workers, by process id.
  [[nodiscard]] const std::map<pid_t, msg::WorkerStatus>& workers() const { return workers_; }
  [[nodiscard]] std::uint64_t tasks_done(const Program& worker) const;
  /// Age of the worker in its last status; -1: there is none yet.
  [[nodiscard]] double uptime_s(const Program& worker) const;

  /// Expects the results of one process, and an answer for every task.
  void expect_same_results();
  /// Workers that the middleware is connected to; a killed one counts until its lease ends.
  [[nodiscard]] std::size_t connected_workers() const {
    return static_cast<std::size_t>(workers_in_.matched());
  }

  /// Prints the localizer's longest recovery from the loss of a worker; fails without any.
  void report_recovery();

 private:
  void send_scan();

  const Scratch& scratch_;
  const Drive& drive_;
  std::filesystem::path out_;
  messaging::ParticipantOptions options_;
  messaging::Participant participant_;
  messaging::Writer<msg::Scan> scan_writer_;
  messaging::Writer<msg::StreamEnd> end_writer_;
  messaging::Reader<msg::TrajectorySegment> segments_in_;
  messaging::Reader<msg::StreamEnd> ends_in_;
  messaging::Reader<msg::ServiceStatus> statuses_in_;
  messaging::Reader<msg::WorkerStatus> workers_in_;
  messaging::EventLoop loop_;
  std::vector<std::unique_ptr<Program>> services_;
  std::vector<std::unique_ptr<Program>> own_workers_;
  Program* localizer_ = nullptr;
  std::size_t next_scan_ = 0;
  std::size_t stops_ = 0;
  bool ended_ = false;
  msg::ServiceStatus status_;
  std::map<pid_t, msg::WorkerStatus> workers_;
};

}  // namespace topogeo::test
