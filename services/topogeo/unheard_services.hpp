// Services that exist but do not publish their status: they are known from discovery or from the
// list of processes of this host.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "topogeo/messaging/discovery.hpp"
#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/status.h"

#include "host_processes.hpp"

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

  /// Services of that domain and partition ("*": all partitions).
  UnheardServices(std::uint32_t domain, std::string partition)
      : domain_(domain), partition_(std::move(partition)) {}

  /// A status has come.
  void heard(const msg::ServiceStatus& status, const messaging::SampleInfo& info);
  /// Replaces the endpoints that discovery knows.
  void discovered(std::span<const messaging::RemoteEndpoint> endpoints, Time now);
  /// Replaces the running services of the host with that name.
  void running(std::vector<HostProcess> processes, const std::string& host);

  /// Whether a discovered service may still publish its first status.
  [[nodiscard]] bool may_come(Time now) const;
  /// The services that should have been heard by now, each once, by name.
  [[nodiscard]] std::vector<UnheardService> list(Time now) const;

 private:
  struct Writer {
    std::string participant;
    Time since;
  };

  std::uint32_t domain_;
  std::string partition_;
  std::set<messaging::Handle> heard_;  // writers of statuses
  // Host, service, process: services in containers may have the same number.
  std::set<std::tuple<std::string, std::string, std::uint32_t>> processes_heard_;
  std::map<messaging::Handle, Writer> writers_;  // discovered writers
  std::vector<HostProcess> running_;
  std::string host_;
};

}  // namespace topogeo::cli
