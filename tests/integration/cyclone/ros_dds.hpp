// Topics of ROS 2 on Cyclone DDS, like a node of rmw_cyclonedds: names, types and quality of
// service of ROS, on a different DDS implementation from ours.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>

#include "dds/dds.h"

namespace topogeo::test {

inline dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity >= 0) return entity;
  std::cerr << "ros_peer: " << what << ": " << dds_strretcode(-entity) << '\n';
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): one thread
}

enum class PeerQos { kSensor, kReliable, kLatched };

/// A participant of a domain of ROS.
class RosPeer {
 public:
  explicit RosPeer(std::uint32_t domain)
      : participant_(checked(dds_create_participant(domain, nullptr, nullptr), "participant")) {}
  RosPeer(const RosPeer&) = delete;
  RosPeer& operator=(const RosPeer&) = delete;
  ~RosPeer() { dds_delete(participant_); }

  /// `name` with its slash: "/scan".
  [[nodiscard]] dds_entity_t writer(const dds_topic_descriptor_t& type, const std::string& name,
                                    PeerQos qos) const {
    return make(type, name, qos, dds_create_writer);
  }
  [[nodiscard]] dds_entity_t reader(const dds_topic_descriptor_t& type, const std::string& name,
                                    PeerQos qos) const {
    return make(type, name, qos, dds_create_reader);
  }

 private:
  template <class Create>
  [[nodiscard]] dds_entity_t make(const dds_topic_descriptor_t& type, const std::string& name,
                                  PeerQos kind, Create create) const {
    constexpr int kDepth = 100;
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(
        qos, kind == PeerQos::kSensor ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
        DDS_SECS(1));
    dds_qset_durability(
        qos, kind == PeerQos::kLatched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kind == PeerQos::kLatched ? 1 : kDepth);
    const dds_entity_t topic = checked(
        dds_create_topic(participant_, &type, ("rt" + name).c_str(), nullptr, nullptr), name);
    const dds_entity_t entity = checked(create(participant_, topic, qos, nullptr), name);
    dds_delete_qos(qos);
    return entity;
  }

  dds_entity_t participant_;
};

template <class Message>
void write(dds_entity_t writer, const Message& message) {
  checked(dds_write(writer, &message), "write");
}

inline bool has_reader(dds_entity_t writer) {
  dds_publication_matched_status_t status;
  checked(dds_get_publication_matched_status(writer, &status), "matched");
  return status.current_count > 0;
}

/// Passes on received messages.
template <class Message>
void take(dds_entity_t reader, const std::function<void(const Message&)>& handler) {
  constexpr int kMost = 16;
  for (;;) {
    void* samples[kMost] = {};
    dds_sample_info_t infos[kMost];
    const int count = checked(dds_take(reader, samples, infos, kMost, kMost), "take");
    for (int i = 0; i < count; ++i) {
      if (infos[i].valid_data) handler(*static_cast<const Message*>(samples[i]));
    }
    if (count > 0) dds_return_loan(reader, samples, count);
    if (count < kMost) return;
  }
}

inline void pause_ms(int duration_ms) {
  dds_sleepfor(DDS_MSECS(duration_ms));
}

}  // namespace topogeo::test
