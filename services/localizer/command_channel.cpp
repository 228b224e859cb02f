#include "command_channel.hpp"

#include <stdexcept>
#include <utility>

namespace topogeo::localizer {

CommandChannel::CommandChannel(service::Service& service, std::function<void()> on_arrival)
    : service_(service), on_arrival_(std::move(on_arrival)), replies_(service) {
  service.subscribe<msg::LocalizationCommand>(
      [this](const msg::LocalizationCommand& command) { on_command(command); });
}

void CommandChannel::on_command(const msg::LocalizationCommand& message) {
  if (replies_.came_before(message.request_id(), message.client_id().to_string())) return;
  try {
    waiting_.push_back(service::from_msg(message));
  } catch (const std::invalid_argument& error) {
    replies_.reply(message.request_id(), message.client_id().to_string(), {false, error.what()}, 0);
    throw;
  }
  on_arrival_();
}

void CommandChannel::carry_out(const Handler& handler, std::int64_t stamp_ns) {
  while (!waiting_.empty()) {
    const service::LocalizationCommand command = std::move(waiting_.front());
    waiting_.pop_front();
    replies_.reply(command.request_id, command.client_id, handler(command), stamp_ns);
  }
}

}  // namespace topogeo::localizer
