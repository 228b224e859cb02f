#include "topogeo/service/goal_outbox.hpp"

namespace topogeo::service {
namespace {

bool is_change(const msg::Goal& message) {
  return message.kind() == msg::kGoalPause || message.kind() == msg::kGoalResume;
}

}  // namespace

GoalOutbox::GoalOutbox(Service& service)
    : service_(service),
      goals_(service.advertise<msg::Goal>()),
      changes_(service.advertise<msg::Goal>()) {}

bool GoalOutbox::send(const msg::Goal& message) {
  if (!is_change(message)) waiting_.clear();
  waiting_.push_back(message);
  return flush();
}

void GoalOutbox::note_navigator(const messaging::SampleInfo& status) {
  if (navigator_ && *navigator_ != status.writer) {
    waiting_.clear();
    was_connected_ = false;
  }
  navigator_ = status.writer;
  was_connected_ = was_connected_ || is_connected();
  static_cast<void>(flush());
}

bool GoalOutbox::flush() {
  if (waiting_.empty() || (navigator_ && !is_connected())) return true;
  // One at a time: the writer keeps only its last message, which replaces one under way.
  const msg::Goal message = waiting_.front();
  waiting_.pop_front();
  return service_.send(is_change(message) ? changes_ : goals_, message, "goal");
}

}  // namespace topogeo::service
