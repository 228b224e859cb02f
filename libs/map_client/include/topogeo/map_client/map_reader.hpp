// Follows the map of a robot over DDS (Fast DDS), including samples that the map store sent before
// the start. Needs only the generated types of topogeo.
#pragma once

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/msg/map_updatePubSubTypes.h"

namespace topogeo::map_client {

/// TOPOGEO_DOMAIN of the environment, as for the commands of topogeo; 0 if it is unset or no domain
/// (0 to 232).
inline std::uint32_t default_domain() {
  constexpr std::uint32_t kLargestDomain = 232;
  const char* const value = std::getenv("TOPOGEO_DOMAIN");  // NOLINT(concurrency-mt-unsafe)
  const std::string_view text = value == nullptr ? "" : value;
  std::uint32_t domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && domain <= kLargestDomain ? domain : 0;
}

struct MapReaderOptions {
  std::string robot_id = "robot";
  std::uint32_t domain = default_domain();  ///< DDS domain; unused with a participant
  /// Partition of the services; "*": all. `topogeo run` has one of its own. Name one where two runs
  /// of a robot name share the domain.
  std::string partition = "*";
  /// Participant of the calling program, which must outlive the reader. Null: creates its own one
  /// with default settings.
  eprosima::fastdds::dds::DomainParticipant* participant = nullptr;
  /// A map that stays incomplete is read again from its beginning: after this time without a
  /// sample, or after ten times as long in any case. Each successive attempt waits twice as long as
  /// the previous one, up to 32 times.
  std::chrono::milliseconds patience{2000};
};

/// Not thread-safe.
class MapReader {
 public:
  /// Joins the domain. Throws std::runtime_error if the middleware refuses.
  explicit MapReader(const MapReaderOptions& options = {});
  MapReader(const MapReader&) = delete;
  MapReader& operator=(const MapReader&) = delete;
  ~MapReader();

  /// Returns as soon as map() has changed; false after `timeout`.
  bool wait(std::chrono::nanoseconds timeout);
  /// Takes the available samples. True if map() has changed.
  bool take();

  /// The same as in MapFollower.
  [[nodiscard]] const Map* map() const { return follower_.map(); }
  [[nodiscard]] bool is_current() const { return follower_.is_current(); }
  std::vector<Change> take_changes() { return follower_.take_changes(); }

  /// Number of connected map stores.
  [[nodiscard]] int stores() const;
  /// Number of times the map was read again.
  [[nodiscard]] int restarts() const { return restarts_; }

 private:
  using Clock = std::chrono::steady_clock;

  void open();
  void make_reader();
  void close();
  void start_again_if_stuck();

  MapReaderOptions options_;
  MapFollower follower_;
  eprosima::fastdds::dds::TypeSupport type_{new msg::MapElementPubSubType};
  bool own_participant_ = false;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  eprosima::fastdds::dds::Topic* topic_ = nullptr;
  eprosima::fastdds::dds::DataReader* reader_ = nullptr;
  msg::MapElement element_;  // reused, so that its points keep their capacity
  Clock::time_point last_news_ = Clock::now();
  Clock::time_point last_whole_ = Clock::now();  // or last read again
  int restarts_ = 0;
  int restarts_in_a_row_ = 0;  // without a complete map in between
};

inline MapReader::MapReader(const MapReaderOptions& options)
    : options_(options), follower_(options.robot_id) {
  try {
    open();
  } catch (...) {
    close();
    throw;
  }
}

inline MapReader::~MapReader() {
  close();
}

inline void MapReader::open() {
  namespace dds = eprosima::fastdds::dds;
  const auto require = [](const auto* entity, const char* what) {
    if (entity == nullptr) throw std::runtime_error(std::string("DDS: cannot create ") + what);
  };
  dds::DomainParticipant*& participant = options_.participant;
  if (participant == nullptr) {
    own_participant_ = true;
    participant = dds::DomainParticipantFactory::get_instance()->create_participant(
        options_.domain, dds::PARTICIPANT_QOS_DEFAULT);
    require(participant, "a participant");
  }
  type_.register_type(participant);
  dds::SubscriberQos qos = dds::SUBSCRIBER_QOS_DEFAULT;
  qos.partition().push_back(options_.partition.c_str());
  subscriber_ = participant->create_subscriber(qos);
  require(subscriber_, "a subscriber");
  // Topic names include the version of the wire contract, so peers with other versions do not
  // match.
  const std::string name = "topogeo/v" + std::to_string(msg::kSchemaVersion) + "/map";
  // Reuses a topic that the program already has; looking it up creates another object for it.
  topic_ = participant->lookup_topicdescription(name) != nullptr
               ? participant->find_topic(name, {0, 0})
               : participant->create_topic(name, type_.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  require(topic_, name.c_str());
  make_reader();
}

inline void MapReader::make_reader() {
  namespace dds = eprosima::fastdds::dds;
  // Matches the offer of the map store's writer (role `state` in deploy/dds_profiles.xml): the last
  // sample of each element, also for late readers. The reader keeps all waiting samples: with a
  // history of one per element, a sample from another writer would replace that of the store, which
  // is never sent again. If the limit of an element is reached, the store resends.
  constexpr int kMostElements = 32768;
  constexpr int kMostOfAnElement = 256;
  constexpr int kAllocatedAtFirst = 16;
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  qos.resource_limits().max_samples = kMostElements * kMostOfAnElement;
  qos.resource_limits().max_instances = kMostElements;
  qos.resource_limits().max_samples_per_instance = kMostOfAnElement;
  qos.resource_limits().allocated_samples = kAllocatedAtFirst;
  // In another namespace in each version of Fast DDS.
  using MemoryPolicy = decltype(qos.endpoint().history_memory_policy);
  qos.endpoint().history_memory_policy = MemoryPolicy::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  reader_ = subscriber_->create_datareader(topic_, qos);
  if (reader_ == nullptr) throw std::runtime_error("DDS: cannot create a reader of the map");
}

inline void MapReader::close() {
  if (options_.participant == nullptr) return;
  if (reader_ != nullptr) subscriber_->delete_datareader(reader_);
  if (subscriber_ != nullptr) options_.participant->delete_subscriber(subscriber_);
  if (topic_ != nullptr) options_.participant->delete_topic(topic_);
  if (own_participant_) {
    eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->delete_participant(
        options_.participant);
  }
}

inline bool MapReader::take() {
  namespace dds = eprosima::fastdds::dds;
  bool changed = false;
  dds::SampleInfo info;
  const auto handle = [](const dds::InstanceHandle_t& from) {
    Handle to;
    std::copy_n(static_cast<const std::uint8_t*>(from.value), to.size(), to.begin());
    return to;
  };
  // Success is the default in all versions of Fast DDS, which have return codes of different types.
  using ReturnCode = decltype(reader_->take_next_sample(&element_, &info));
  while (reader_->take_next_sample(&element_, &info) == ReturnCode()) {
    last_news_ = Clock::now();
    const Handle instance = handle(info.instance_handle);
    const Handle writer = handle(info.publication_handle);
    if (info.valid_data) {
      changed |= follower_.put(element_, instance, writer);
    } else if (info.instance_state != dds::NOT_ALIVE_NO_WRITERS_INSTANCE_STATE) {
      // Disposed; alive if a waiting sample was sent after the disposal.
      changed |= follower_.remove(instance, writer);
    }
  }
  return changed;
}

inline bool MapReader::wait(std::chrono::nanoseconds timeout) {
  constexpr std::chrono::milliseconds kSlice{100};  // between two checks for a stuck map
  const Clock::time_point end = Clock::now() + timeout;
  while (!take()) {
    start_again_if_stuck();
    const auto left = std::chrono::nanoseconds(end - Clock::now());
    if (left.count() <= 0) return false;
    const auto slice = std::min<std::chrono::nanoseconds>(left, kSlice);
    reader_->wait_for_unread_message({0, static_cast<std::uint32_t>(slice.count())});
  }
  return true;
}

inline void MapReader::start_again_if_stuck() {
  constexpr int kMostDoublings = 5;
  constexpr int kWhateverComes = 10;  // multiple of the patience
  const Clock::time_point now = Clock::now();
  if (follower_.is_current() || stores() == 0) {
    last_news_ = last_whole_ = now;
    restarts_in_a_row_ = 0;
    return;
  }
  const auto patience = options_.patience * (1 << std::min(restarts_in_a_row_, kMostDoublings));
  if (now - last_news_ < patience && now - last_whole_ < kWhateverComes * patience) return;
  subscriber_->delete_datareader(reader_);
  reader_ = nullptr;
  follower_.begin_again();
  make_reader();
  last_news_ = last_whole_ = Clock::now();
  ++restarts_;
  ++restarts_in_a_row_;
}

inline int MapReader::stores() const {
  eprosima::fastdds::dds::SubscriptionMatchedStatus status;
  reader_->get_subscription_matched_status(status);
  return status.current_count;
}

}  // namespace topogeo::map_client
