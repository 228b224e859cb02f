#include "topogeo/service_table.hpp"

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

// The status of a service that was killed stays for a while beside that of its next life.
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

}  // namespace
}  // namespace topogeo::cli
