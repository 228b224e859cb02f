// Services that exist but do not publish their status: they are known from discovery or from the
// list of processes of this host.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "topogeo/messaging/discovery.hpp"
#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/status.h"

#include "common/host_processes.hpp"

namespace topogeo::cli {

/// An unheard service, for the table of `topogeo status`.
struct UnheardService {
  std::string name;    ///< "localizer"
  std::string reason;  ///< "discovery finds robot/localizer, and it publishes no status"
};

/// The caller passes the time, which must never go back.
class UnheardServices {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Time that a service has for its first status, counted from its discovery.
  static constexpr std::chrono::milliseconds kFirstStatus{1500};
  /// A process younger than this may not have joined its domain yet.
  static constexpr double kStarting_s = 10.0;
  /// Time after its last status for which a heard service accounts for its process: StatusTable
  /// shows it that long.
  static constexpr std::chrono::seconds kRemembered{10};

  /// Services of that domain and partition ("*": all partitions).
  UnheardServices(std::uint32_t domain, std::string partition)
      : domain_(domain), partition_(std::move(partition)) {}

  /// A status has come.
  void heard(const msg::ServiceStatus& status, const messaging::SampleInfo& info, Time now);
  /// Replaces the endpoints that discovery knows.
  void discovered(std::span<const messaging::RemoteEndpoint> endpoints, Time now);
  /// Replaces the running services of the host with that name.
  void running(std::vector<HostProcess> processes, const std::string& host);

  /// Whether a discovered service may still publish its first status.
  [[nodiscard]] bool may_come(Time now) const;
  /// The services that should have been heard by now, each once, by name.
  [[nodiscard]] std::vector<UnheardService> list(Time now) const;

 private:
  /// Name and number of a process in its own PID namespace. Processes in several containers may
  /// share both.
  using Numbered = std::pair<std::string, std::uint32_t>;
  struct Writer {
    std::string participant;
    Time since;
  };

  /// Processes of this host without a heard service of their own.
  [[nodiscard]] std::vector<UnheardService> silent_processes(Time now) const;
  /// Services heard lately on this host with that name and number.
  [[nodiscard]] std::size_t services_heard(const Numbered& name, Time now) const;

  std::uint32_t domain_;
  std::string partition_;
  std::set<messaging::Handle> heard_;  // writers of statuses
  // Time of the last status of each instance, by host and process.
  std::map<std::pair<std::string, Numbered>, std::map<std::string, Time>> instances_;
  std::map<messaging::Handle, Writer> writers_;  // discovered writers
  std::vector<HostProcess> running_;
  std::string host_;
};

}  // namespace topogeo::cli
