// Prints the motion of a simulated robot, a line for each ground truth: milliseconds since 1970,
// m/s, rad/s, collisions so far; or, with --commands, the first three for each motion command. Has
// the flags of a service; ends with SIGTERM.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/simulation.h"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

namespace topogeo::test {
namespace {

std::int64_t now_ms() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

void print(const msg::GroundTruth& truth) {
  std::cout << now_ms() << ' ' << std::abs(truth.linear_mps()) << ' '
            << std::abs(truth.angular_radps()) << ' ' << truth.collisions() << std::endl;
}

void print_command(const msg::MotionCommand& command) {
  std::cout << now_ms() << ' ' << std::abs(command.linear_mps()) << ' '
            << std::abs(command.angular_radps()) << std::endl;
}

}  // namespace
}  // namespace topogeo::test

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  bool commands = false;
  return service::run_service(
      argc, argv, "drive_watch", "Prints how a simulated robot moves.",
      [&](command_line::Command& app) {
        app.add_flag("--commands", commands, "the motion commands that its base gets");
      },
      [&](const service::Setup& setup) {
        service::Service service(setup);
        if (commands) {
          service.subscribe<msg::MotionCommand>(test::print_command);
        } else {
          service.subscribe<msg::GroundTruth>(test::print);
        }
        service.run();
      });
}
