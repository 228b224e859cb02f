// Strangers who speak DDS: samples of the right types with absurd content, bytes that are no
// message, topics that do not exist.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"
#include "topogeo/support/random.hpp"

namespace topogeo::test {

/// Sends whatever bytes it is given as samples of a type.
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

/// A participant of Fast DDS that keeps none of our rules.
class Stranger {
 public:
  explicit Stranger(std::uint32_t domain) {
    namespace dds = eprosima::fastdds::dds;
    dds::DomainParticipantQos qos;
    qos.name("stranger");
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

  eprosima::fastdds::dds::DataWriter& writer(const std::string& topic, const std::string& type) {
    namespace dds = eprosima::fastdds::dds;
    const dds::TypeSupport support(new AnyBytes(type));  // NOLINT: it takes it over
    support.register_type(participant_);
    dds::DataWriterQos qos;
    qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().depth = 64;
    qos.endpoint().history_memory_policy =
        eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return *publisher_->create_datawriter(
        participant_->create_topic(topic, type, dds::TOPIC_QOS_DEFAULT), qos);
  }

 private:
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
};

/// Samples that keep the bounds of the types and mean nothing.
class AbsurdSamples {
 public:
  explicit AbsurdSamples(const messaging::Participant& participant)
      : goals_(participant), segments_(participant), poses_(participant) {}

  /// Whether somebody reads them, within the time.
  [[nodiscard]] bool wait_for_readers(std::chrono::seconds patience) {
    return goals_.wait_for_matched(1, patience) && segments_.wait_for_matched(1, patience);
  }

  /// One of each type.
  void write(std::uint64_t number) {
    constexpr std::int64_t kYear2250_ns = 8'830'000'000'000'000'000;
    msg::Goal goal;
    messaging::set_header(goal, "robot", kYear2250_ns, number);
    messaging::set_client_id(goal, "stranger");
    goal.target().x_m(std::nan(""));
    static_cast<void>(goals_.write(goal));
    msg::TrajectorySegment segment;
    messaging::set_header(segment, "robot", -kYear2250_ns, number);
    segment.segment(0xFFFFFFF0U + static_cast<std::uint32_t>(number % 8));
    segment.total_stops(0xFFFFFFFF);
    segment.stops().resize(2);
    static_cast<void>(segments_.write(segment));
    msg::LivePose pose;
    messaging::set_header(pose, "robot", kYear2250_ns, number);
    pose.confidence(-1e300);
    static_cast<void>(poses_.write(pose));
  }

 private:
  messaging::Writer<msg::Goal> goals_;
  messaging::Writer<msg::TrajectorySegment> segments_;
  messaging::Writer<msg::LivePose> poses_;
};

/// Samples on all topics that are no message: cut off, counts of four billion, truth values of 255,
/// no text's end.
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
