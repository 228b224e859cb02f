// Commands to the localizer. They are accepted on arrival and carried out between two steps,
// because messages also arrive while a step waits for its matches.
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

  /// `on_arrival` is called for every command that can be carried out; call carry_out() soon after.
  /// Throws like Reader and Writer.
  CommandChannel(service::Service& service, std::function<void()> on_arrival);

  /// Passes arrived commands to the handler, in order, and sends its answers. `stamp_ns`
  /// is the stamp of the last stop.
  void carry_out(const Handler& handler, std::int64_t stamp_ns);

 private:
  void on_command(const msg::LocalizationCommand& message);

  service::Service& service_;
  std::function<void()> on_arrival_;
  ReplySender replies_;
  std::deque<service::LocalizationCommand> waiting_;
};

}  // namespace topogeo::localizer
