// Selection of workers: versions, fingerprints, ids that two processes share.
#include "topogeo/search_pool/worker_registry.hpp"

#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::search_pool {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ProcessId process(std::uint8_t number) {
  ProcessId id{};
  id[0] = number;
  return id;
}

InstanceId instance(std::uint8_t number) {
  InstanceId id{};
  id[3] = number;
  return id;
}

WorkerReport report(const std::string& worker_id, const Build& build = {"1.0", 0xabc, 0}) {
  return {worker_id, "pc7", build};
}

class RegistryTest : public ::testing::Test {
 protected:
  WorkerRegistry registry_{Build{"1.0", 0xabc, 0x12}};
};

TEST_F(RegistryTest, AWorkerThatAgreesIsUsed) {
  const auto verdict = registry_.update(report("w#1"), process(1), instance(1));
  EXPECT_TRUE(verdict.usable);
  EXPECT_FALSE(verdict.fault);
  EXPECT_TRUE(registry_.update(report("w#2", {"1.0", 0xabc, 0x12}), process(2), instance(2)).usable)
      << "given the same configuration";
  EXPECT_TRUE(registry_.is_owner(process(1), "w#1"));
  EXPECT_FALSE(registry_.is_owner(process(2), "w#1"));
  EXPECT_FALSE(registry_.is_owner(process(1), "w#3"));
  EXPECT_THAT(registry_.workers_of(process(2)), ElementsAre("w#2"));
  EXPECT_EQ(registry_.name("w#1"), "worker w#1 on host pc7");
  EXPECT_EQ(registry_.owner("w#2"), process(2));
  EXPECT_EQ(registry_.owner("w#3"), ProcessId{});
}

TEST_F(RegistryTest, AnotherVersionIsRefusedOnceWithBothNamed) {
  const WorkerReport other = report("w#1", {"2.0", 0xabc, 0});
  const auto verdict = registry_.update(other, process(1), instance(1));
  EXPECT_FALSE(verdict.usable);
  ASSERT_TRUE(verdict.fault);
  EXPECT_EQ(verdict.fault->reason, "worker of another version");
  EXPECT_EQ(verdict.fault->detail, "worker w#1 on host pc7: version 2.0, here 1.0");
  EXPECT_FALSE(registry_.update(other, process(1), instance(1)).fault);
  registry_.gone(instance(1), process(1));
  const auto again = registry_.update(other, process(1), instance(1));
  EXPECT_FALSE(again.usable);
  EXPECT_FALSE(again.fault) << "also when it comes back";
  EXPECT_EQ(registry_.counts().other_version, 1U);
}

TEST_F(RegistryTest, AnotherMatcherAndAnotherConfigurationAreRefused) {
  const auto matcher = registry_.update(report("w#1", {"1.0", 0xabd, 0}), process(1), instance(1));
  EXPECT_FALSE(matcher.usable);
  ASSERT_TRUE(matcher.fault);
  EXPECT_EQ(matcher.fault->reason, "worker computes differently");
  EXPECT_THAT(matcher.fault->detail, HasSubstr("0000000000000abd, here 0000000000000abc"));
  const auto config =
      registry_.update(report("w#2", {"1.0", 0xabc, 0x13}), process(2), instance(2));
  EXPECT_FALSE(config.usable);
  ASSERT_TRUE(config.fault);
  EXPECT_EQ(config.fault->reason, "worker of another configuration");
  EXPECT_THAT(config.fault->detail, HasSubstr("0000000000000013, here 0000000000000012"));
  EXPECT_EQ(registry_.counts().other_version, 0U);
  EXPECT_EQ(registry_.counts().other_matcher, 1U);
  EXPECT_EQ(registry_.counts().other_configuration, 1U);
}

TEST_F(RegistryTest, OfTwoProcessesWithOneIdTheFirstIsUsedUntilItGoes) {
  registry_.update(report("w#1"), process(1), instance(1));
  const auto second = registry_.update(report("w#1"), process(2), instance(1));
  EXPECT_FALSE(second.usable);
  ASSERT_TRUE(second.fault);
  EXPECT_EQ(second.fault->reason, "two workers of one id");
  EXPECT_FALSE(registry_.update(report("w#1"), process(2), instance(1)).fault) << "reported once";
  EXPECT_EQ(registry_.counts().shared_ids, 1U);
  EXPECT_TRUE(registry_.update(report("w#1"), process(1), instance(1)).usable);
  EXPECT_FALSE(registry_.is_owner(process(2), "w#1"));
  EXPECT_FALSE(registry_.gone(instance(1), process(2))) << "the second one goes";
  EXPECT_TRUE(registry_.is_owner(process(1), "w#1"));
  registry_.update(report("w#1"), process(2), instance(1));
  EXPECT_EQ(registry_.gone(instance(1), process(1)), "w#1");
  EXPECT_TRUE(registry_.is_owner(process(1), "w#1")) << "answers may still come";
  EXPECT_TRUE(registry_.update(report("w#1"), process(2), instance(1)).usable);
  EXPECT_TRUE(registry_.is_owner(process(2), "w#1"));
  EXPECT_FALSE(registry_.is_owner(process(1), "w#1"));
}

TEST_F(RegistryTest, SilentWorkersAreGone) {
  registry_.update(report("w#1"), process(1), instance(1));
  registry_.update(report("w#2"), process(2), instance(2));
  EXPECT_THAT(registry_.tick(2), IsEmpty());
  EXPECT_THAT(registry_.tick(2), IsEmpty());
  registry_.update(report("w#2"), process(2), instance(2));
  EXPECT_THAT(registry_.tick(2), ElementsAre("w#1"));
  EXPECT_THAT(registry_.tick(2), IsEmpty());
  EXPECT_THAT(registry_.tick(2), ElementsAre("w#2"));
  EXPECT_TRUE(registry_.update(report("w#1"), process(1), instance(1)).usable) << "it woke up";
}

TEST_F(RegistryTest, ALossWithoutANameIsLeftToSilenceWhenTwoShareTheId) {
  registry_.update(report("w#1"), process(1), instance(1));
  registry_.update(report("w#1"), process(2), instance(1));
  EXPECT_FALSE(registry_.gone(instance(1), ProcessId{}));
  registry_.update(report("w#2"), process(3), instance(2));
  EXPECT_EQ(registry_.gone(instance(2), ProcessId{}), "w#2");
  EXPECT_FALSE(registry_.gone(instance(2), ProcessId{})) << "gone already";
  // The first of the two is silent from now on.
  registry_.tick(1);
  registry_.update(report("w#1"), process(2), instance(1));
  EXPECT_THAT(registry_.tick(1), ElementsAre("w#1"));
  EXPECT_TRUE(registry_.update(report("w#1"), process(2), instance(1)).usable);
}

}  // namespace
}  // namespace topogeo::search_pool
