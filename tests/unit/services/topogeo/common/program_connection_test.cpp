// A command for the base of one robot while another robot is connected first.
#include "topogeo/common/program_connection.hpp"

#include <chrono>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "messaging/fixture.hpp"
#include "waiting.hpp"

namespace topogeo::cli {
namespace {

using messaging::Participant;
using messaging::Reader;
using messaging::Writer;

class ProgramConnection : public messaging::TwoParticipants {
 protected:
  [[nodiscard]] bool connect(double patience_s) {
    support::Patience patience(patience_s, support::monotonic_s());
    return connect_with_program(statuses_, commands_, patience, [](const msg::BaseStatus& status) {
      return status.robot_id() == "robot";
    });
  }
  static msg::BaseStatus status_of(const std::string& robot) {
    msg::BaseStatus status;
    messaging::set_header(status, robot, 0, 0);
    return status;
  }

  Participant& command_ = sender_;
  Participant& base_ = receiver_;
  Reader<msg::BaseStatus> statuses_{command_};
  Writer<msg::BaseCommand> commands_{command_};
};

TEST_F(ProgramConnection, IsNotThatWithAnotherRobot) {
  const Participant other(messaging::options_in(partition_));
  const Reader<msg::BaseCommand> other_commands(other);
  Writer<msg::BaseStatus> other_statuses(other);
  Writer<msg::BaseStatus> own_statuses(base_);
  ASSERT_TRUE(test::wait_for("all but the commands to the own base", [&] {
    return commands_.matched() == 1 && other_statuses.matched() == 1 && own_statuses.matched() == 1;
  }));
  ASSERT_TRUE(other_statuses.write(status_of("other")));
  ASSERT_TRUE(own_statuses.write(status_of("robot")));
  EXPECT_FALSE(connect(0.2)) << "only the other base takes commands";
  const Reader<msg::BaseCommand> own_commands(base_);
  ASSERT_TRUE(own_statuses.write(status_of("robot")));
  EXPECT_TRUE(connect(std::chrono::duration<double>(test::hang_limit()).count()));
}

}  // namespace
}  // namespace topogeo::cli
