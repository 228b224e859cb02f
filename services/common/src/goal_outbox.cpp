#include "topogeo/service/goal_outbox.hpp"

namespace topogeo::service {

GoalOutbox::GoalOutbox(Service& service)
    : service_(service), goals_(service.advertise<msg::Goal>()) {}

bool GoalOutbox::send(const msg::Goal& message) {
  const bool refers_to_previous =
      message.kind() == msg::kGoalPause || message.kind() == msg::kGoalResume;
  if (!refers_to_previous) waiting_.clear();
  waiting_.push_back(message);
  return flush();
}

void GoalOutbox::note_navigator(const messaging::SampleInfo& status) {
  if (navigator_ && *navigator_ != status.writer) {
    waiting_.clear();
    was_connected_ = false;
  }
  navigator_ = status.writer;
  was_connected_ = was_connected_ || goals_.connected_with(status.writer);
  static_cast<void>(flush());
}

bool GoalOutbox::flush() {
  if (waiting_.empty() || (navigator_ && !goals_.connected_with(*navigator_))) return true;
  // One at a time: the writer keeps only its last message, which replaces one under way.
  const msg::Goal message = waiting_.front();
  waiting_.pop_front();
  return service_.send(goals_, message, "goal");
}

}  // namespace topogeo::service
