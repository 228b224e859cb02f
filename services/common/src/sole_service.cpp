#include "topogeo/service/sole_service.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <tuple>

#include "topogeo/support/format.hpp"

namespace topogeo::service {

namespace {

// Services of one network find each other in a tenth of a second. Later statuses count, too.
constexpr std::chrono::milliseconds kListening{300};
// Lets the other service count the refusal: it publishes its status twice a second.
constexpr std::chrono::seconds kFarewell{1};

/// Whether both have the same task for the same robot.
bool are_rivals(const msg::ServiceStatus& a, const msg::ServiceStatus& b) {
  const bool same = a.instance() == b.instance() && a.started_ns() == b.started_ns();
  return !same && a.service() == b.service() && a.robot_id() == b.robot_id();
}

}  // namespace

bool has_precedence(const msg::ServiceStatus& other, const msg::ServiceStatus& own) {
  if (!are_rivals(other, own) || other.state() == msg::kServiceStopped) return false;
  const auto rank = [](const msg::ServiceStatus& status) {
    return std::tuple(status.state() == msg::kServiceStarting, status.started_ns(),
                      status.instance_key());
  };
  return rank(other) < rank(own);
}

SoleService::SoleService(Service& service) : service_(service) {
  service_.subscribe<msg::ServiceStatus>(
      [this](const msg::ServiceStatus& other) { compare(other); }, {.any_robot = true});
  const bool stopped = service_.loop().run_for(kListening);
  listening_ = false;
  if (!refused_.empty()) {
    const auto end = std::chrono::steady_clock::now() + kFarewell;
    while (!counted_ && !stopped && std::chrono::steady_clock::now() < end) {
      service_.loop().run_for(kListening / 10);
    }
    throw std::runtime_error(refused_);
  }
  // A signal that arrived meanwhile also ends the loop that follows.
  if (stopped) service_.loop().stop();
}

void SoleService::compare(const msg::ServiceStatus& received) {
  const msg::ServiceStatus& own = service_.status().message();
  // The service works for the robots that share the map, too.
  msg::ServiceStatus other = received;
  if (service_.shares_map(other.robot_id().to_string())) other.robot_id(own.robot_id());
  if (!are_rivals(other, own) || other.state() == msg::kServiceStopped) return;
  const std::string fault = fmt::format("second {}", own.service().c_str());
  if (!refused_.empty()) {
    counted_ |= std::ranges::any_of(other.faults(), [&](const msg::FaultCount& count) {
      return count.reason() == fault.c_str();
    });
  } else if (has_precedence(other, own)) {
    refused_ = fmt::format("another {} already runs for robot '{}': {}; this one stops",
                           own.service().c_str(), own.robot_id().c_str(), other.instance().c_str());
    service_.status().set_state(msg::kServiceFailed, refused_);
    if (!listening_) throw std::runtime_error(refused_);
  } else if (reported_.insert(other.instance().to_string()).second) {
    service_.status().fault(fault, fmt::format("{} was started for the same robot and must stop",
                                               other.instance().c_str()));
  }
}

}  // namespace topogeo::service
