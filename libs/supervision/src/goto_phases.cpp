#include "topogeo/supervision/goto_phases.hpp"

#include "topogeo/support/format.hpp"

namespace topogeo::supervision {

GotoAction GotoPhases::step(double now_s, const GotoView& view) {
  clock_.advance(now_s, view.busy.empty() ? 1.0 : 0.0);
  switch (phase_) {
    case Phase::kWaiting:
      return wait_for_start(now_s, view);
    case Phase::kDriving:
      return drive(now_s, view);
    case Phase::kCallingOff:
      return wait_for_stop(view);
    case Phase::kEnded:
      break;
  }
  return GotoAction::kNone;
}

GotoAction GotoPhases::wait_for_start(double now_s, const GotoView& view) {
  if (view.waits_for.empty()) {
    phase_ = Phase::kDriving;
    sent_s_ = now_s;
    return GotoAction::kSendGoal;
  }
  if (clock_.time_s() < kStart_s) return GotoAction::kNone;
  phase_ = Phase::kEnded;
  failure_ = fmt::format("still waits for {} after {:.0f} s", view.waits_for, kStart_s);
  return GotoAction::kFail;
}

GotoAction GotoPhases::drive(double now_s, const GotoView& view) {
  if (!view.end) return GotoAction::kNone;
  drive_s_ = now_s - sent_s_;
  arrived_ = view.end->arrived;
  if (arrived_) {
    phase_ = Phase::kEnded;
    return GotoAction::kEnd;
  }
  failure_ = view.end->reason;
  call_off();
  return GotoAction::kCallOff;
}

bool GotoPhases::call_off() {
  if (phase_ == Phase::kCallingOff || phase_ == Phase::kEnded) return false;
  phase_ = Phase::kCallingOff;
  called_off_s_ = clock_.time_s();
  return true;
}

GotoAction GotoPhases::wait_for_stop(const GotoView& view) {
  if (!view.stands && clock_.time_s() - called_off_s_ <= kCallOff_s) return GotoAction::kNone;
  phase_ = Phase::kEnded;
  return GotoAction::kEnd;
}

}  // namespace topogeo::supervision
