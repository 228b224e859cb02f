#include "topogeo/common/service_table.hpp"

#include <string>

#include <gtest/gtest.h>

namespace topogeo::cli {
namespace {

msg::ServiceStatus status_of(const std::string& instance, std::int64_t started_ns) {
  msg::ServiceStatus status;
  status.service("local_mapper");
  status.instance(instance.c_str());
  status.started_ns(started_ns);
  return status;
}

messaging::SampleInfo sample(std::uint8_t key) {
  messaging::SampleInfo info;
  info.instance.bytes[0] = key;
  return info;
}

// The status of a killed service remains for a while beside that of its next life.
TEST(ServiceTable, FindsTheOneThatStartedLast) {
  ServiceTable table;
  EXPECT_EQ(table.find("local_mapper"), nullptr);
  table.update(status_of("robot-17", 5), sample(1));
  table.update(status_of("robot-9", 9), sample(2));
  table.update(status_of("robot-8", 2), sample(3));
  ASSERT_NE(table.find("local_mapper"), nullptr);
  EXPECT_EQ(table.find("local_mapper")->instance().to_string(), "robot-9");
  table.remove(sample(2));
  EXPECT_EQ(table.find("local_mapper")->instance().to_string(), "robot-17");
  EXPECT_EQ(table.find("localizer"), nullptr);
}

TEST(ServiceTable, WhatTheMachineGivesIsNoProgress) {
  ServiceTable table;
  msg::ServiceStatus status = status_of("robot-17", 5);
  msg::Counter counter;
  for (const char* name : {"cpu_wait_ratio", "timer_delay_s", "cpu_short", "scans"}) {
    counter.name(name);
    status.counters().push_back(counter);
  }
  table.update(status, sample(1));
  const std::string mark = table.progress_mark();
  EXPECT_EQ(describe_states(table).find("CPU"), std::string::npos);
  for (std::size_t i = 0; i < 3; ++i) status.counters()[i].value(1.0);
  table.update(status, sample(1));
  EXPECT_EQ(table.progress_mark(), mark);
  EXPECT_NE(describe_states(table).find("the CPU is short: timers fire up to 1.0 s late"),
            std::string::npos);
  status.counters()[3].value(1.0);
  table.update(status, sample(1));
  EXPECT_NE(table.progress_mark(), mark);
}

}  // namespace
}  // namespace topogeo::cli
