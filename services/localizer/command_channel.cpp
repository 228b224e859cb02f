#include "command_channel.hpp"

#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"

namespace topogeo::localizer {

CommandChannel::CommandChannel(service::Service& service, std::function<void()> on_arrival)
    : service_(service),
      on_arrival_(std::move(on_arrival)),
      replies_(service.advertise<msg::LocalizationReply>()) {
  service.subscribe<msg::LocalizationCommand>(
      [this](const msg::LocalizationCommand& command) { on_command(command); });
}

void CommandChannel::on_command(const msg::LocalizationCommand& message) {
  try {
    waiting_.push_back(service::from_msg(message));
  } catch (const std::invalid_argument& error) {
    reply(message.request_id(), message.client_id().to_string(), {false, error.what()}, 0);
    throw;
  }
  on_arrival_();
}

void CommandChannel::carry_out(const Handler& handler, std::int64_t stamp_ns) {
  while (!waiting_.empty()) {
    const service::LocalizationCommand command = std::move(waiting_.front());
    waiting_.pop_front();
    reply(command.request_id, command.client_id, handler(command), stamp_ns);
  }
}

void CommandChannel::reply(std::uint64_t request_id, const std::string& client_id,
                           const CommandAnswer& answer, std::int64_t stamp_ns) {
  msg::LocalizationReply message;
  messaging::set_header(message, service_.robot_id(), stamp_ns, sequence_++);
  message.request_id(request_id);
  messaging::set_text_cut(message.client_id(), client_id);
  message.accepted(answer.accepted);
  messaging::set_text_cut(message.message(), answer.message);
  service_.status().add_to_counter(answer.accepted ? "commands_accepted" : "commands_refused");
  static_cast<void>(service_.send(replies_, message, "reply"));
}

}  // namespace topogeo::localizer
