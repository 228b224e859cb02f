// Writes motion commands in the name of the navigator until it is stopped, and prints their number;
// for the test of security.
//   command_writer DOMAIN PARTITION
#include <chrono>
#include <cstdint>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

namespace {

namespace messaging = topogeo::messaging;
namespace msg = topogeo::msg;

void write_commands(const std::string& domain, const std::string& partition) {
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain));
  options.partition = partition;
  options.name = "robot/navigator";
  options.identity = "navigator";
  const messaging::Participant participant(options);
  messaging::Writer<msg::MotionCommand> commands(participant);
  messaging::EventLoop loop;
  std::uint64_t written = 0;
  // The navigator's period.
  loop.add_timer(std::chrono::milliseconds(50), [&] {
    msg::MotionCommand command;
    messaging::set_header(command, "robot", 0, written);
    command.linear_mps(0.1);
    command.valid_for_s(0.5);
    if (commands.write(command)) std::cout << ++written << std::endl;
  });
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  loop.run();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::invalid_argument("expected DOMAIN PARTITION");
    write_commands(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "command_writer: " << error.what() << '\n';
    return 1;
  }
}
