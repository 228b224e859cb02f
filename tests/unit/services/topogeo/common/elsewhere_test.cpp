// A command that hears nothing, and services with other settings.
#include "topogeo/common/elsewhere.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "topogeo/messaging/topics.hpp"

namespace topogeo::cli {
namespace {

messaging::RemoteEndpoint status_writer_in(const std::string& partition,
                                           const std::string& participant) {
  messaging::RemoteEndpoint endpoint;
  endpoint.participant = participant;
  endpoint.topic = std::string(messaging::kServiceStatus);
  endpoint.writer = true;
  endpoint.partitions = {partition};
  return endpoint;
}

HostProcess process_in(std::uint32_t domain, const std::string& partition,
                       const std::string& robot) {
  return {7, 7, "map_store", domain, partition, false, 60.0, robot};
}

DomainView view_of(std::uint32_t domain, const std::string& partition) {
  DomainView view;
  view.domain = domain;
  view.partition = partition;
  return view;
}

TEST(ServicesElsewhere, AreNamedByDomainPartitionAndRobot) {
  const std::vector<messaging::RemoteEndpoint> discovered = {
      status_writer_in("run-1", "anna/localizer"), status_writer_in("run-1", "anna/planner"),
      status_writer_in("mine", "robot/planner")};
  const std::vector<HostProcess> processes = {process_in(3, "run-1", "anna"),
                                              process_in(5, "topogeo", "")};
  EXPECT_EQ(services_elsewhere(view_of(3, "mine"), discovered, processes),
            "; services run on domain 3, partition 'run-1' (robot 'anna'); domain 5, partition "
            "'topogeo'");
}

TEST(ServicesElsewhere, AreNoneThatTheCommandSees) {
  const std::vector<messaging::RemoteEndpoint> discovered = {
      status_writer_in("run-1", "anna/localizer"), status_writer_in("run-1/anna", "anna/planner")};
  const std::vector<HostProcess> processes = {process_in(3, "run-1", "anna")};
  EXPECT_EQ(services_elsewhere(view_of(3, "*"), discovered, processes), "");
  EXPECT_EQ(services_elsewhere(view_of(3, "run-1"), discovered, processes), "");
}

TEST(ServicesElsewhere, LeaveOutWorkersOfAllPartitionsAndOtherTopics) {
  messaging::RemoteEndpoint scans = status_writer_in("other", "anna/sensor_gateway");
  scans.topic = "topogeo/v17/scan";
  const std::vector<messaging::RemoteEndpoint> discovered = {scans,
                                                             status_writer_in("*", "ga_worker")};
  const std::vector<HostProcess> processes = {process_in(3, "*", "")};
  EXPECT_EQ(services_elsewhere(view_of(3, "mine"), discovered, processes), "");
}

}  // namespace
}  // namespace topogeo::cli
