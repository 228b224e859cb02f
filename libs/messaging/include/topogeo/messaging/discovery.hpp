// Readers and writers that discovery announces in a domain, and those that cannot connect.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "topogeo/messaging/events.hpp"

namespace topogeo::messaging {

/// The part of a reader's or writer's quality of service that decides whether two of them connect.
/// Object Management Group, DDS 1.4, chapter 2.2.3: a writer must not offer less than a reader
/// requests.
struct OfferedQos {
  bool reliable = false;
  std::uint32_t durability = 0;  ///< 0 volatile, 1 transient-local, 2 transient, 3 persistent
  double deadline_s = 0.0;       ///< 0: none
  std::uint32_t liveliness = 0;  ///< 0 automatic, 1 by participant, 2 by topic
  double lease_s = 0.0;          ///< of the liveliness; 0: none
  bool exclusive = false;        ///< ownership
};

/// A reader or writer of another process.
struct RemoteEndpoint {
  Handle id;
  std::string participant;  ///< name of its participant; empty while unknown
  std::string topic;        ///< with prefix and version
  std::string type;
  bool writer = false;
  std::vector<std::string> partitions;
  OfferedQos qos;
};

/// A writer and a reader that share a topic and a partition but cannot connect.
struct Mismatch {
  RemoteEndpoint writer;
  RemoteEndpoint reader;
  std::string what;  ///< the policy, or "type"
};

/// All mismatches, one for each topic, pair of participants and policy.
std::vector<Mismatch> find_mismatches(std::span<const RemoteEndpoint> endpoints);

/// The version of the wire contract in a topic's name: 17 for "topogeo/v17/scan"; 0 for foreign
/// topics.
std::uint32_t wire_version(const std::string& topic);

}  // namespace topogeo::messaging
