// Commands to the localizer: taken when they come, carried out between two steps, because a step
// waits for its matches while messages arrive.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>

#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service.hpp"

#include "localizer_commands.hpp"
#include "reply_sender.hpp"

namespace topogeo::localizer {

class CommandChannel {
 public:
  using Handler = std::function<CommandAnswer(const service::LocalizationCommand& command)>;

  /// `on_arrival` is called for every command that can be carried out; carry_out() then is to be
  /// called soon. Throws like Reader and Writer.
  CommandChannel(service::Service& service, std::function<void()> on_arrival);

  /// Gives the commands that have come to the handler, in order, and sends its answers.
  /// `stamp_ns` is that of the last stop.
  void carry_out(const Handler& handler, std::int64_t stamp_ns);

 private:
  void on_command(const msg::LocalizationCommand& message);

  service::Service& service_;
  std::function<void()> on_arrival_;
  ReplySender replies_;
  std::deque<service::LocalizationCommand> waiting_;
};

}  // namespace topogeo::localizer
