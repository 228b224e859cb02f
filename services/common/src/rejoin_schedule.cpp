#include "topogeo/service/rejoin_schedule.hpp"

#include <algorithm>

namespace topogeo::service {

using messaging::DeafnessWatch;

// A service that is deaf from its start counts this run as the second deaf one, even without a file
// that records the first.
std::uint32_t RejoinSchedule::lives_before(const InputState& input) const {
  return std::max(deaf_lives_, input.ever_came ? 0U : 1U);
}

double RejoinSchedule::wait_s(const InputState& input) const {
  const std::uint32_t lives = lives_before(input);
  if (lives == 0) return 0.0;
  return lives == 1 ? kFirstWait_s : kNextWait_s;
}

// The pause is as long as the silence so far, so a service is deaf for no longer than the
// interruption that caused it.
void RejoinSchedule::decide_probe(const InputState& input) {
  if (probes_) {
    if (input.hears_sender || input.silence_s < probe_since_s_ + kProbe_s) return;
    probes_ = false;
    probe_due_s_ = input.silence_s + std::min(probe_since_s_, kLongestPause_s);
  } else if (!input.hears_sender && input.silence_s >= probe_due_s_) {
    probes_ = true;
    probe_since_s_ = input.silence_s;
  }
}

RejoinStep RejoinSchedule::step(const InputState& input, double now_s) {
  if (input.silence_s < DeafnessWatch::kSilence_s) {
    if (input.ever_came) deaf_lives_ = 0;
    probes_ = false;
    listens_ = false;
    deaf_ = false;
    return {};
  }
  if (!listens_) {
    listens_ = true;
    probe_due_s_ = input.silence_s + kListen_s;
  }
  decide_probe(input);
  RejoinStep step{.listen = true, .probe = probes_, .report = false, .end = false};
  if (!input.deaf) {
    deaf_ = false;
    return step;
  }
  if (!deaf_) {
    deaf_ = true;
    deaf_since_s_ = now_s;
    report_due_s_ = now_s;
  }
  step.report = now_s >= report_due_s_;
  if (step.report) report_due_s_ = now_s + kReportEvery_s;
  step.end = now_s - deaf_since_s_ >= wait_s(input);
  if (step.end) deaf_lives_ = lives_before(input) + 1;
  return step;
}

}  // namespace topogeo::service
