#include "discovery_listener.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include "endpoint_shared.hpp"
#include "robot_partitions.hpp"

namespace topogeo::messaging {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

double seconds_of(const eprosima::fastrtps::Duration_t& duration) {
  constexpr double kNanosecond_s = 1e-9;
  if (duration == eprosima::fastrtps::c_TimeInfinite) return 0.0;
  return static_cast<double>(duration.seconds) + kNanosecond_s * duration.nanosec;
}

/// Readers and writers have the same policies in two types.
template <class Data, class Qos>
RemoteEndpoint to_endpoint(const Data& data, const Qos& qos, bool writer) {
  RemoteEndpoint endpoint;
  endpoint.id = detail::to_handle(rtps::InstanceHandle_t(data.guid()));
  endpoint.topic = data.topicName().to_string();
  endpoint.type = data.typeName().to_string();
  endpoint.writer = writer;
  endpoint.partitions = qos.m_partition.names();
  endpoint.qos.reliable = qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  endpoint.qos.durability = static_cast<std::uint32_t>(qos.m_durability.kind);
  endpoint.qos.deadline_s = seconds_of(qos.m_deadline.period);
  endpoint.qos.liveliness = static_cast<std::uint32_t>(qos.m_liveliness.kind);
  endpoint.qos.lease_s = seconds_of(qos.m_liveliness.lease_duration);
  endpoint.qos.exclusive = qos.m_ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS;
  return endpoint;
}

void leave_robots_out(std::vector<std::string>& partitions) {
  for (std::string& name : partitions) name = partition_without_robot(name);
  std::ranges::sort(partitions);
  partitions.erase(std::unique(partitions.begin(), partitions.end()), partitions.end());
}

}  // namespace

void DiscoveryListener::on_participant_discovery(dds::DomainParticipant* participant,
                                                 rtps::ParticipantDiscoveryInfo&& info) {
  {
    const std::lock_guard lock(endpoints_mutex_);
    const rtps::GuidPrefix_t& prefix = info.info.m_guid.guidPrefix;
    if (info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
        info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
      names_.erase(prefix);
      std::erase_if(endpoints_,
                    [&](const auto& entry) { return entry.first.guidPrefix == prefix; });
    } else if (names_.size() < kMostEndpoints) {
      names_[prefix] = info.info.m_participantName.to_string();
    }
  }
  RefusalListener::on_participant_discovery(participant, std::move(info));
}

void DiscoveryListener::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                               rtps::WriterDiscoveryInfo&& info) {
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    remove(info.info.guid());
  } else {
    put(info.info.guid(), to_endpoint(info.info, info.info.m_qos, true));
  }
}

void DiscoveryListener::on_subscriber_discovery(dds::DomainParticipant* participant,
                                                rtps::ReaderDiscoveryInfo&& info) {
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    remove(info.info.guid());
  } else {
    put(info.info.guid(), to_endpoint(info.info, info.info.m_qos, false));
  }
  RefusalListener::on_subscriber_discovery(participant, std::move(info));
}

std::vector<RemoteEndpoint> DiscoveryListener::endpoints() const {
  const std::lock_guard lock(endpoints_mutex_);
  std::vector<RemoteEndpoint> all;
  for (const auto& [guid, endpoint] : endpoints_) {
    all.push_back(endpoint);
    const auto name = names_.find(guid.guidPrefix);
    if (name != names_.end()) all.back().participant = name->second;
  }
  return all;
}

std::size_t DiscoveryListener::participants() const {
  const std::lock_guard lock(endpoints_mutex_);
  return names_.size();
}

void DiscoveryListener::put(const rtps::GUID_t& guid, RemoteEndpoint endpoint) {
  if (by_robot_) leave_robots_out(endpoint.partitions);
  const std::lock_guard lock(endpoints_mutex_);
  if (endpoints_.size() >= kMostEndpoints && !endpoints_.contains(guid)) return;
  endpoints_[guid] = std::move(endpoint);
}

void DiscoveryListener::remove(const rtps::GUID_t& guid) {
  const std::lock_guard lock(endpoints_mutex_);
  endpoints_.erase(guid);
}

}  // namespace topogeo::messaging
