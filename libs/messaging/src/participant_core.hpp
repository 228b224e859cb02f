// The Fast DDS side of a Participant.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/ContentFilteredTopic.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/messaging/detail/endpoint.hpp"
#include "topogeo/messaging/participant.hpp"

#include "discovery_listener.hpp"
#include "freeze_watch.hpp"
#include "revocation_list.hpp"

namespace topogeo::messaging {

/// Owns the DDS participant with one publisher and one subscriber in the partition.
class ParticipantCore {
 public:
  explicit ParticipantCore(const ParticipantOptions& options);
  ParticipantCore(const ParticipantCore&) = delete;
  ParticipantCore& operator=(const ParticipantCore&) = delete;
  ~ParticipantCore();

  [[nodiscard]] eprosima::fastdds::dds::Publisher& publisher() const { return *publisher_; }
  [[nodiscard]] eprosima::fastdds::dds::Subscriber& subscriber() const { return *subscriber_; }

  /// The topic, made on first use.
  eprosima::fastdds::dds::Topic& topic(const TopicInfo& info);
  /// The messages of the topic for `addressee`. Throws std::runtime_error when its messages have no
  /// addressee.
  eprosima::fastdds::dds::ContentFilteredTopic& make_filtered(const TopicInfo& info,
                                                              const std::string& addressee);
  void remove_filtered(eprosima::fastdds::dds::ContentFilteredTopic& topic);

  [[nodiscard]] bool secured() const { return secured_; }
  /// With security: whether the permissions of a peer's writer name the robot. Any writer may send
  /// a message for no robot, and this participant may write for any robot.
  [[nodiscard]] bool may_write_for(const Handle& writer, std::string_view robot) const;
  std::vector<std::string> take_refusals();
  bool take_new_revocations();
  [[nodiscard]] std::optional<std::chrono::nanoseconds> stood_still() const;
  [[nodiscard]] std::vector<RemoteEndpoint> discovered() const;
  [[nodiscard]] std::size_t peers() const;
  /// Whole names of the topics that the program of another participant's reader announced to read
  /// as well.
  [[nodiscard]] std::vector<std::string> read_with(const Handle& reader) const;
  /// Why an endpoint was not made, as logged by the security plug-ins; empty without security.
  [[nodiscard]] std::string reason_of_denial() const;

 private:
  bool secured_ = false;
  RevocationList revocations_;
  std::optional<FreezeWatch> freeze_watch_;     // always, once the profile is known
  std::unique_ptr<ReadWithListener> listener_;  // called while participant_ lives
  RefusalListener* refusals_ = nullptr;         // the listener of a participant with security
  DiscoveryListener* observer_ = nullptr;       // the listener of a participant that observes
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  std::mutex mutex_;
  std::map<std::string, eprosima::fastdds::dds::Topic*, std::less<>> topics_;
  std::uint64_t filters_made_ = 0;
};

}  // namespace topogeo::messaging
