// The operator's stop where the base of another robot is connected before that of the own one.
#include "orders/hand_sender.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"

#include "channels/event_log.hpp"
#include "messaging/fixture.hpp"
#include "waiting.hpp"

namespace topogeo::web {
namespace {

service::Setup page_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

class HandSenderTest : public testing::Test {
 protected:
  HandSenderTest() {
    service_.subscribe<msg::BaseStatus>(
        [this](const msg::BaseStatus&, const messaging::SampleInfo& info) {
          hand_.note_base(info.writer);
          base_noted_ = true;
        });
  }
  [[nodiscard]] bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_for(what, condition,
                          [&] { service_.loop().run_for(std::chrono::milliseconds(5)); });
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{page_setup(partition_)};
  Board board_;
  EventLog events_{board_};
  HandSender hand_{service_, board_, events_,
                   [] { return std::shared_ptr<const planning::HybridMap>(); }};
  bool base_noted_ = false;
  messaging::Participant base_{messaging::options_in(partition_)};
  messaging::Participant other_{messaging::options_in(partition_)};
};

TEST_F(HandSenderTest, AStopReachesABaseThatIsConnectedLate) {
  const messaging::Reader<msg::BaseCommand> other_base(other_);
  messaging::Writer<msg::BaseStatus> statuses(base_);
  ASSERT_TRUE(run_until("another base and the status of the own one",
                        [&] { return other_base.matched() > 0 && statuses.matched() > 0; }));
  ASSERT_TRUE(statuses.write(messaging::message<msg::BaseStatus>()));
  ASSERT_TRUE(run_until("the status", [&] { return base_noted_; }));
  EXPECT_FALSE(hand_.stop()) << "another base hears it, the own one does not";
  messaging::Reader<msg::BaseCommand> commands(base_);
  std::optional<msg::BaseCommandKind> kind;
  EXPECT_TRUE(run_until("the stop at the base", [&] {
    commands.take([&](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
      if (info.valid) kind = command.kind();
    });
    return kind.has_value();
  }));
  EXPECT_EQ(kind, msg::kBaseHalt);
  EXPECT_TRUE(hand_.stop());
}

}  // namespace
}  // namespace topogeo::web
