#include "topogeo/service/sole_service.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"

namespace topogeo::service {
namespace {

msg::ServiceStatus map_store(const std::string& instance, std::int64_t started_ns,
                             msg::ServiceState state = msg::kServiceRunning) {
  msg::ServiceStatus out;
  messaging::set_header(out, "robot", 0, 0);
  messaging::set_service(out, "map_store", instance);
  out.started_ns(started_ns);
  out.state(state);
  return out;
}

TEST(SoleService, TheOneThatStartedFirstStays) {
  EXPECT_TRUE(has_precedence(map_store("a", 1), map_store("b", 2)));
  EXPECT_FALSE(has_precedence(map_store("b", 2), map_store("a", 1)));
}

// A wrong clock must not stop a service that already works.
TEST(SoleService, WhoWorksIsOlderThanWhoStarts) {
  const msg::ServiceStatus starting = map_store("a", 1, msg::kServiceStarting);
  for (const msg::ServiceState state :
       {msg::kServiceWaiting, msg::kServiceRunning, msg::kServiceFinished, msg::kServiceFailed}) {
    EXPECT_TRUE(has_precedence(map_store("b", 2, state), starting));
    EXPECT_FALSE(has_precedence(starting, map_store("b", 2, state)));
  }
}

TEST(SoleService, OneOfTwoHasPrecedenceWhateverTheyAre) {
  const std::vector<msg::ServiceStatus> all = {map_store("a", 1),
                                               map_store("b", 1),
                                               map_store("a", 2),
                                               map_store("c", 0),
                                               map_store("a", 1, msg::kServiceStarting),
                                               map_store("d", 1, msg::kServiceStarting)};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < all.size(); ++j) {
      const bool same =
          all[i].instance() == all[j].instance() && all[i].started_ns() == all[j].started_ns();
      EXPECT_EQ(has_precedence(all[i], all[j]) + has_precedence(all[j], all[i]), same ? 0 : 1);
    }
  }
}

TEST(SoleService, OthersAreNoRivals) {
  const msg::ServiceStatus own = map_store("b", 2);
  EXPECT_FALSE(has_precedence(map_store("a", 1, msg::kServiceStopped), own));
  EXPECT_FALSE(has_precedence(own, own));
  const auto changed = [&](const std::function<void(msg::ServiceStatus&)>& change) {
    msg::ServiceStatus other = map_store("a", 1);
    change(other);
    return other;
  };
  EXPECT_FALSE(has_precedence(changed([](auto& s) { s.robot_id("other"); }), own));
  EXPECT_FALSE(
      has_precedence(changed([](auto& s) { messaging::set_service(s, "localizer", "a"); }), own));
}

}  // namespace
}  // namespace topogeo::service
