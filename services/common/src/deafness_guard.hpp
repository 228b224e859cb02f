// Ends a service whose main input is dead although its sender sends. The restarted service
// discovers the sender anew.
#pragma once

#include <optional>
#include <stdexcept>

#include "topogeo/messaging/deafness.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/status_publisher.hpp"
#include "topogeo/msg/status.h"
#include "topogeo/service/rejoin_schedule.hpp"
#include "topogeo/service/service_options.hpp"

#include "deaf_lives.hpp"

namespace topogeo::service {

/// Ends the service for a restart. It is no failure, which would end all services that need it.
struct Deaf final : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Costs nothing while the input arrives: the statuses of others are read only once it is silent.
/// They are read through the service's participant, and through another one, a probe, when that
/// does not hear the sender at all. Lives in the thread of the loop.
class DeafnessGuard {
 public:
  /// All arguments must outlive it. `any_robot`: same as for the participant of the service.
  DeafnessGuard(const Setup& setup, bool any_robot, const messaging::Participant& participant,
                messaging::EventLoop& loop, messaging::StatusPublisher& status);

  /// Call it several times a second. It sets the counter "deaf" and the fault of that name. Throws
  /// Deaf when the service must end.
  void tick();

 private:
  using Time = messaging::DeafnessWatch::Time;

  void listen();
  void hear_probe(Time now);
  void probe(bool wanted);

  const Setup& setup_;
  const bool any_robot_;
  const messaging::Participant& participant_;
  messaging::EventLoop& loop_;
  messaging::StatusPublisher& status_;
  DeafLives memory_;
  RejoinSchedule schedule_;
  bool remembered_;  // by the file
  bool deaf_ = false;
  messaging::DeafnessWatch watch_;
  std::optional<messaging::Reader<msg::ServiceStatus>> statuses_;
  struct Probe {
    messaging::Participant participant;
    messaging::Reader<msg::ServiceStatus> statuses;
  };
  std::optional<Probe> probe_;
  bool probe_failed_ = false;  // it could not be made
};

}  // namespace topogeo::service
