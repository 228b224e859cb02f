#include "topogeo/service/service_options.hpp"

#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

using testing::HasSubstr;

struct Outcome {
  int code = -1;
  bool ran = false;
  Setup setup;
  std::string told;  // stderr
};

Outcome run(
    std::vector<const char*> arguments, const std::function<void()>& body = [] {}) {
  arguments.insert(arguments.begin(), "test_service");
  Outcome outcome;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  outcome.code = run_service(static_cast<int>(arguments.size()), arguments.data(), "test_service",
                             "A test.", {}, [&](const Setup& setup) {
                               outcome.ran = true;
                               outcome.setup = setup;
                               body();
                             });
  testing::internal::GetCapturedStdout();
  outcome.told = testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(RunService, FlagsReachTheBody) {
  const Outcome outcome = run({"--domain", "7", "--partition", "p", "--robot-id", "r"});
  EXPECT_EQ(outcome.code, kOk);
  EXPECT_EQ(outcome.setup.options.domain, 7U);
  EXPECT_EQ(outcome.setup.options.partition, "p");
  EXPECT_EQ(outcome.setup.options.robot_id, "r");
}

TEST(RunService, DefaultsAreAsDocumented) {
  const Outcome outcome = run({});
  EXPECT_EQ(outcome.setup.options.domain, 0U);
  EXPECT_EQ(outcome.setup.options.partition, "topogeo");
  EXPECT_EQ(outcome.setup.options.robot_id, "robot");
}

struct MetricsEnvironment {
  MetricsEnvironment(const char* port, const char* address) {
    ::setenv("TOPOGEO_METRICS_PORT", port, 1);
    ::setenv("TOPOGEO_METRICS_ADDRESS", address, 1);
  }
  ~MetricsEnvironment() {
    ::unsetenv("TOPOGEO_METRICS_PORT");
    ::unsetenv("TOPOGEO_METRICS_ADDRESS");
  }
};

TEST(RunService, TheEnvironmentOfAContainerAsksForMetrics) {
  EXPECT_EQ(run({}).setup.config.config.metrics.port, 0U);
  const auto plain = run({}).setup.config.effective.fingerprint;
  {
    const MetricsEnvironment asked("9464", "0.0.0.0");
    const Outcome outcome = run({});
    EXPECT_EQ(outcome.setup.config.config.metrics.port, 9464U);
    EXPECT_EQ(outcome.setup.config.config.metrics.address, "0.0.0.0");
    EXPECT_EQ(outcome.setup.config.effective.fingerprint, plain);
  }
  {
    const MetricsEnvironment unset("", "");
    EXPECT_EQ(run({}).setup.config.config.metrics.port, 0U);
    EXPECT_EQ(run({}).setup.config.config.metrics.address, "127.0.0.1");
  }
  for (const char* wrong : {"port", "9464x", "-1", "65001"}) {
    const MetricsEnvironment asked(wrong, "");
    const Outcome outcome = run({});
    EXPECT_EQ(outcome.code, kUsage);
    EXPECT_FALSE(outcome.ran);
    EXPECT_THAT(outcome.told, HasSubstr("TOPOGEO_METRICS_PORT: expected a port"));
    EXPECT_THAT(outcome.told, HasSubstr(wrong));
  }
}

TEST(RunService, RobotsThatShareAMapHaveNamesOfTheirOwn) {
  const auto setup = run({"--robot-id", "a"}).setup;
  EXPECT_EQ(with_robots(setup, {"b", "c"}).options.other_robots,
            (std::vector<std::string>{"b", "c"}));
  EXPECT_TRUE(with_robots(setup, {}).options.other_robots.empty());
  const std::vector<std::vector<std::string>> all_wrong = {
      {"a"}, {"b", "b"}, {""}, {std::string(33, 'b')}};
  for (const std::vector<std::string>& wrong : all_wrong) {
    EXPECT_THROW(with_robots(setup, wrong), UsageError);
  }
  EXPECT_EQ(with_map_of(setup, "b").options.map_robot, "b");
}

TEST(RunService, HelpAndVersionEndWell) {
  for (const char* flag : {"--help", "--version"}) {
    const Outcome outcome = run({flag});
    EXPECT_EQ(outcome.code, kOk);
    EXPECT_FALSE(outcome.ran);
  }
}

TEST(RunService, WrongUseIsToldInOneLine) {
  const std::vector<std::vector<const char*>> wrong = {
      {"--nonsense"}, {"--domain", "233"},          {"--robot-id", ""},
      {"surplus"},    {"--config", "/nonexistent"}, {"--log-level", "loud"}};
  for (const auto& arguments : wrong) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, kUsage) << arguments[0];
    EXPECT_FALSE(outcome.ran);
    EXPECT_THAT(outcome.told, HasSubstr("test_service: "));
    EXPECT_EQ(std::count(outcome.told.begin(), outcome.told.end(), '\n'), 1) << outcome.told;
  }
}

TEST(RunService, ExceptionsBecomeExitCodes) {
  EXPECT_EQ(run({}, [] { throw std::runtime_error("broken"); }).code, kFailure);
  EXPECT_EQ(run({}, [] { throw UsageError("wrong"); }).code, kUsage);
  const Outcome outcome = run({}, [] { throw BadInputError("log.clf: no scans"); });
  EXPECT_EQ(outcome.code, kBadInput);
  EXPECT_EQ(outcome.told, "test_service: log.clf: no scans\n");
}

}  // namespace
}  // namespace topogeo::service
