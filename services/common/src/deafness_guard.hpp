// Ends a service whose main input is dead while its sender sends, so that it is started again and
// meets the sender anew.
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

/// Ends the service, to be started again: it has not failed, which would end all that need it.
struct Deaf final : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Costs nothing while the input comes: the statuses of others are read once it is silent. They
/// come by the participant of the service, and where that does not hear the sender at all by
/// another one, a probe. Lives in the thread of the loop.
class DeafnessGuard {
 public:
  /// All must outlive it. `any_robot`: as for the participant of the service.
  DeafnessGuard(const Setup& setup, bool any_robot, const messaging::Participant& participant,
                messaging::EventLoop& loop, messaging::StatusPublisher& status);

  /// Several times a second. The counter "deaf" and the fault of that name show what it finds.
  /// Throws Deaf when the service shall end.
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
