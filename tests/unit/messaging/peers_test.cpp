// Hosts named by TOPOGEO_PEERS, for services without multicast.
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// The resolver refuses an empty label without a network.
constexpr const char* kUnknownHost = "pc..9";

// Needs a separate process, as ctest provides: only the first 32 participants of a host are tried,
// and a process counts all participants that it ever had.
class Peers : public testing::Test {
 protected:
  Peers() {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_)));
  }
  ~Peers() override {
    ::unsetenv("TOPOGEO_PEERS");
    spdlog::set_default_logger(before_);
  }

  // Skips in a process with many tests: a peer without a port is tried among the first participants
  // of its host only, and the middleware's numbers in a process only grow.
  void SetUp() override {
    constexpr int kFewTests = 10;
    if (testing::UnitTest::GetInstance()->test_to_run_count() > kFewTests) {
      GTEST_SKIP() << "for a process that runs few tests";
    }
  }

  /// Whether two participants with these peers discover each other.
  static bool hear_each_other(const std::string& peers) {
    ::setenv("TOPOGEO_PEERS", peers.c_str(), 1);
    const std::string partition = random_partition();
    const Participant sender(options_in(partition));
    const Participant receiver(options_in(partition));
    Writer<msg::Goal> writer(sender);
    Reader<msg::Goal> reader(receiver);
    return writer.write(message<msg::Goal>()) && wait_for_data(reader);
  }

  std::ostringstream log_;

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

TEST_F(Peers, AddressesNamesAndGapsInTheList) {
  EXPECT_TRUE(hear_each_other("127.0.0.1;;localhost;"));
  EXPECT_TRUE(hear_each_other(";"));
  EXPECT_THAT(log_.str(), IsEmpty());
}

TEST_F(Peers, ANameThatIsNotKnownIsLeftOutWithAWarning) {
  EXPECT_TRUE(hear_each_other(std::string("127.0.0.1;") + kUnknownHost));
  EXPECT_THAT(log_.str(),
              AllOf(HasSubstr("warning"), HasSubstr("TOPOGEO_PEERS"),
                    HasSubstr(std::string("'") + kUnknownHost + "'"), Not(HasSubstr("127.0.0.1"))));
}

TEST_F(Peers, WithoutAnyThatIsKnownThisHostGoesOn) {
  EXPECT_TRUE(hear_each_other(kUnknownHost));
  EXPECT_THAT(log_.str(), HasSubstr(kUnknownHost));
}

}  // namespace
}  // namespace topogeo::messaging
