#include "deafness_guard.hpp"

#include <chrono>
#include <exception>
#include <string>
#include <utility>

namespace topogeo::service {
namespace {

constexpr const char* kFault = "deaf";

double in_seconds(messaging::DeafnessWatch::Time time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

}  // namespace

DeafnessGuard::DeafnessGuard(const Setup& setup, bool any_robot,
                             const messaging::Participant& participant, messaging::EventLoop& loop,
                             messaging::StatusPublisher& status)
    : setup_(setup),
      any_robot_(any_robot),
      participant_(participant),
      loop_(loop),
      status_(status),
      memory_(DeafLives::place_of(setup)),
      schedule_(memory_.load()),
      remembered_(schedule_.deaf_lives() > 0) {}

void DeafnessGuard::tick() {
  const Time now = std::chrono::steady_clock::now();
  const msg::ServiceStatus& own = status_.message();
  hear_probe(now);
  const std::string why = watch_.check(own, now);
  const InputState input{.silence_s = messaging::input_silence_s(own),
                         .ever_came = own.inputs() > 0,
                         .hears_sender = watch_.hears_sender(own, now),
                         .deaf = !why.empty()};
  const RejoinStep step = schedule_.step(input, in_seconds(now));
  if (std::exchange(deaf_, input.deaf) != input.deaf) {
    status_.set_counter(messaging::kDeafCounter, input.deaf ? 1.0 : 0.0);
  }
  if (remembered_ && schedule_.deaf_lives() == 0) {
    remembered_ = false;
    memory_.store(0);
  }
  if (step.listen && !statuses_) listen();
  probe(step.probe);
  if (step.report) status_.fault(kFault, why);
  if (!step.end) return;
  memory_.store(schedule_.deaf_lives());
  throw Deaf(std::string(kFault) + ": " + why + "; a restart reconnects it to the sender");
}

void DeafnessGuard::listen() {
  statuses_.emplace(participant_);
  loop_.add<msg::ServiceStatus>(
      *statuses_, [this](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
        watch_.hear(status, std::chrono::steady_clock::now());
      });
}

void DeafnessGuard::hear_probe(Time now) {
  if (!probe_) return;
  probe_->statuses.take([&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
    if (info.valid) watch_.hear(status, now);
  });
}

void DeafnessGuard::probe(bool wanted) {
  if (!wanted) {
    probe_.reset();
    probe_failed_ = false;
    return;
  }
  if (probe_ || probe_failed_) return;
  try {
    const messaging::Participant participant =
        make_participant(setup_.options, setup_.name, any_robot_);
    probe_.emplace(Probe{participant, messaging::Reader<msg::ServiceStatus>(participant)});
  } catch (const std::exception& error) {
    probe_failed_ = true;
    status_.fault("no probe", error.what());
  }
}

}  // namespace topogeo::service
