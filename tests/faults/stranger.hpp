// Strangers that use DDS: samples of the right types with absurd content, bytes that are no
// message, topics that do not exist.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/msg/types.h"
#include "topogeo/support/random.hpp"

#include "absurd_payload.hpp"
#include "idl_schema.hpp"

namespace topogeo::test {

/// Sends any bytes as samples of a type.
class AnyBytes final : public eprosima::fastdds::dds::TopicDataType {
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

 public:
  explicit AnyBytes(const std::string& type_name) {
    setName(type_name.c_str());
    m_typeSize = 1 << 16;
    m_isGetKeyDefined = true;
  }
  bool serialize(void* data, Payload* payload) override {
    const auto& bytes = *static_cast<std::string*>(data);
    std::ranges::copy(bytes, payload->data);
    payload->length = static_cast<std::uint32_t>(bytes.size());
    return true;
  }
  bool deserialize(Payload* /*payload*/, void* /*data*/) override { return false; }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string; }  // NOLINT: their interface
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }  // NOLINT
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool) override {
    // Instances by the last byte, so that a writer has several.
    const auto& bytes = *static_cast<std::string*>(data);
    handle->value[0] = bytes.empty() ? 1 : static_cast<std::uint8_t>(bytes.back() | 1);
    return true;
  }
};

/// A participant of Fast DDS that follows none of our rules.
class Stranger {
 public:
  explicit Stranger(std::uint32_t domain) {
    namespace dds = eprosima::fastdds::dds;
    dds::DomainParticipantQos qos;
    qos.name("stranger");
    // Services receive no larger packets (deploy/dds_profiles.xml).
    auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    transport->maxMessageSize = 1400;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(std::move(transport));
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    dds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back("*");
    publisher_ = participant_->create_publisher(publisher_qos);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  ~Stranger() {
    participant_->delete_contained_entities();
    eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->delete_participant(
        participant_);
  }

  /// A writer of arbitrary bytes.
  eprosima::fastdds::dds::DataWriter& writer(const std::string& topic, const std::string& type) {
    return writer(topic, eprosima::fastdds::dds::TypeSupport(
                             new AnyBytes(type)));  // NOLINT: it takes it over
  }

  eprosima::fastdds::dds::DataWriter& writer(const std::string& topic,
                                             const eprosima::fastdds::dds::TypeSupport& support) {
    namespace dds = eprosima::fastdds::dds;
    support.register_type(participant_);
    dds::DataWriterQos qos;
    qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().depth = 64;
    // The strictest setting that readers of statuses require.
    qos.liveliness().lease_duration = {1, 0};
    qos.liveliness().announcement_period = {0, 250'000'000};
    qos.endpoint().history_memory_policy =
        eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return *publisher_->create_datawriter(
        participant_->create_topic(topic, support.get_type_name(), dds::TOPIC_QOS_DEFAULT), qos);
  }

 private:
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
};

/// Meaningless samples within the bounds of their types, on all topics.
///
/// Without security any valid message takes effect, so none of these is valid for the robot: either
/// none of its floating-point numbers is finite, or it is for another robot. Samples are always for
/// another robot when their type has no such number, or when receivers act without checking it,
/// unless they are refused for another reason.
class AbsurdSamples {
 public:
  AbsurdSamples(const messaging::Participant& participant, std::uint32_t domain)
      : stranger_(domain),
        workers_(participant),
        tasks_(participant),
        requests_(participant),
        schema_(TOPOGEO_SOURCE_DIR "/idl") {
    for (const messaging::TopicInfo* topic : messaging::all_topics()) {
      const eprosima::fastdds::dds::TypeSupport support(topic->make_type());
      const std::string& name = support.get_type_name();
      topics_.push_back({topic, support, name.substr(name.rfind(':') + 1),
                         &stranger_.writer(std::string(topic->name), support)});
    }
  }
  AbsurdSamples(const AbsurdSamples&) = delete;
  AbsurdSamples& operator=(const AbsurdSamples&) = delete;
  ~AbsurdSamples() = default;

  /// Writes one on each topic. Throws std::logic_error when a reader would reject it as malformed.
  void write(std::uint64_t number) {
    meet_peers();
    for (const Topic& topic : topics_) {
      AbsurdPayload payload(schema_, random_, style(topic.type, number));
      send(topic, payload.make(topic.type));
    }
  }

 private:
  struct Topic {
    const messaging::TopicInfo* info;
    eprosima::fastdds::dds::TypeSupport support;
    std::string type;
    eprosima::fastdds::dds::DataWriter* writer;
  };

  /// Collects addressees: statuses, tasks and requests contain the ids of workers and clients.
  void meet_peers() {
    workers_.take([this](const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
      if (info.valid && status.slots() < 1000) worker_ = status.worker_id().to_string();
    });
    const auto meet = [this](const auto& message, const messaging::SampleInfo& info) {
      const std::string robot = message.robot_id().to_string();
      if (info.valid && robot == "robot") clients_.insert(message.client_id().to_string());
    };
    tasks_.take(meet);
    requests_.take(meet);
  }

  AbsurdStyle style(const std::string& type, std::uint64_t number) {
    // A halt, a cancelled goal or a pause would take effect from any sender.
    static const std::map<std::string, std::uint32_t> kRefusable = {
        {"Goal.kind", msg::kGoalPosition}, {"BaseCommand.kind", msg::kBaseSetLimits}};
    // Receivers act on a failure or an end without checking any number.
    static const std::set<std::string> kObeyed = {"RunSummary", "ServiceStatus"};
    // Refused: cells of no state, unrequested pieces, requests for unknown maps and sessions.
    static const std::set<std::string> kRefused = {"GridTile", "MapRequest", "SnapshotRequest",
                                                   "SnapshotPiece"};
    AbsurdStyle style;
    style.enumerators = kRefusable;
    style.texts["worker_id"] = worker_;
    if (!clients_.empty()) {
      style.texts["client_id"] =
          *std::next(clients_.begin(), static_cast<std::ptrdiff_t>(random_.below(clients_.size())));
    }
    style.full = number % 16 == 0;
    const bool can_be_refused =
        kRefused.contains(type) || (has_real(type) && !kObeyed.contains(type));
    if (!can_be_refused || number % 4 == 1) {
      style.robot_id = "stranger";
      style.not_finite = number % 8 == 1;
    }
    return style;
  }

  bool has_real(const std::string& type) const {
    if (!schema_.is_struct(type)) return false;
    return std::ranges::any_of(schema_.members(type), [this](const IdlMember& member) {
      const std::string element =
          std::regex_replace(member.type, std::regex("sequence<([^,]+),.*"), "$1");
      return element == "double" || element == "float" || schema_.array_size(element) > 0 ||
             has_real(element);
    });
  }

  void send(const Topic& topic, const std::string& bytes) {
    eprosima::fastrtps::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
    std::ranges::copy(bytes, payload.data);
    payload.length = static_cast<std::uint32_t>(bytes.size());
    eprosima::fastdds::dds::TypeSupport type = topic.support;
    void* const message = type.create_data();
    static_cast<void>(type.deserialize(&payload, message));
    const auto defect = topic.info->find_defect(message);
    if (!defect) static_cast<void>(topic.writer->write(message));
    type.delete_data(message);
    if (defect) throw std::logic_error(topic.type + ": " + *defect);
  }

  Stranger stranger_;
  messaging::Reader<msg::WorkerStatus> workers_;
  messaging::Reader<msg::MatchTasks> tasks_;
  messaging::Reader<msg::SnapshotRequest> requests_;
  IdlSchema schema_;
  support::Random random_{5};
  std::vector<Topic> topics_;
  std::string worker_ = "stranger";
  std::set<std::string> clients_;
};

/// Malformed samples on all topics: cut off, counts of four billion, truth values of 255, texts
/// without an end.
class NoMessages {
 public:
  explicit NoMessages(std::uint32_t domain) : stranger_(domain) {
    for (const messaging::TopicInfo* topic : messaging::all_topics()) {
      const eprosima::fastdds::dds::TypeSupport type(topic->make_type());
      writers_.push_back(&stranger_.writer(std::string(topic->name), type.get_type_name()));
    }
  }

  /// One on each topic.
  void write(std::uint64_t number) {
    std::string bytes(4 + random_.below(400), number % 2 == 0 ? '\xff' : '\0');
    bytes.replace(0, 4, std::string("\0\1\0\0", 4));
    for (std::size_t at = 4; number % 4 > 1 && at < bytes.size(); ++at) {
      bytes[at] = static_cast<char>(random_.below(256));
    }
    for (auto* writer : writers_) static_cast<void>(writer->write(&bytes));
  }

 private:
  Stranger stranger_;
  std::vector<eprosima::fastdds::dds::DataWriter*> writers_;
  support::Random random_{1};
};

/// Topics that do not exist, with a sample on each.
class UnknownTopics {
 public:
  explicit UnknownTopics(std::uint32_t domain) : stranger_(domain) {}

  void add() {
    const std::string number = std::to_string(number_++);
    stranger_.writer("topogeo/v10/nonsense" + number, "Nonsense" + number).write(&bytes_);
  }

  [[nodiscard]] std::size_t size() const { return number_; }

 private:
  Stranger stranger_;
  std::string bytes_ = std::string(1000, '\xff');
  std::size_t number_ = 0;
};

}  // namespace topogeo::test
