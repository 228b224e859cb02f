// Services and search workers on the hub.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "topogeo/msg/status.h"
#include "topogeo/service/service.hpp"

#include "server/channel_hub.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class HealthView {
 public:
  HealthView(service::Service& service, ChannelHub& hub, EventLog& events);

  /// Charge of the battery in [0, 100] as the gateway reports it; empty unless the base measures
  /// it.
  [[nodiscard]] std::optional<double> battery_percent() const;
  /// Whether a service of that name runs for the robot.
  [[nodiscard]] bool runs(const std::string& service) const;

 private:
  struct Row {
    std::string service;
    msg::ServiceState state = msg::kServiceStarting;
    bool lost = false;
    std::uint64_t faults = 0;
    msg::ServiceStatus last;  ///< last report of a service that may be lost
  };

  void on_service(const msg::ServiceStatus& status, const messaging::SampleInfo& info);
  void on_service_gone(const messaging::SampleInfo& info);
  void on_worker(const msg::WorkerStatus& status, const messaging::SampleInfo& info);
  void on_worker_gone(const messaging::SampleInfo& info);
  void note(Row& row, const msg::ServiceStatus& status);

  ChannelHub& hub_;
  EventLog& events_;
  std::string robot_id_;
  std::map<std::string, Row> rows_;  // by the channel's key
  std::map<messaging::Handle, std::string> keys_;
  std::map<messaging::Handle, std::string> workers_;
};

}  // namespace topogeo::web
