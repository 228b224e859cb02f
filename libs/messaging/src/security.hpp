// DDS security of a participant: its certificate and permissions, and the peers that it refuses.
// Object Management Group, DDS Security 1.1, chapters 8 and 9; Fast DDS has the built-in plug-ins.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "read_with.hpp"

namespace topogeo::messaging {

/// Turns authentication, access control and encryption on, with the files that
/// deploy/security/make_keys writes into `folder`. Throws std::runtime_error that names the file
/// that is missing, and when ROS_DISCOVERY_SERVER is set: Fast DDS 2.9 has no security there, and
/// participants would find nobody without a word.
void add_security(eprosima::fastdds::dds::DomainParticipantQos& qos,
                  const std::filesystem::path& folder);

/// Lets a participant, writer or reader use a session key for 16 MB instead of 512 bytes: making
/// one takes longer than encrypting a message. The random part of the initialization vector has 64
/// bits, so two of the million messages of a key have the same one with a probability of 3e-8 (NIST
/// SP 800-38D, chapter 8).
void use_long_sessions(eprosima::fastrtps::rtps::PropertyPolicy& properties);

/// Does nothing; whoever calls it gets what security_races.cpp puts right linked in.
void keep_security_races_away();

/// A writer or reader of a peer that security keeps from ours, or a sample of such a writer.
struct Denial {
  eprosima::fastrtps::rtps::GuidPrefix_t peer;
  std::string topic;
  bool writer = false;
  bool other_governance = false;  // its endpoint is protected otherwise than the topic is here
  std::string robot = {};         // of the sample; empty: the whole writer or reader is kept away
};

/// Adds one to what the RefusalListener of this process reports next. From any thread.
void note_denial(Denial denial);

/// Does nothing; whoever calls it gets what security_denials.cpp notes linked in.
void note_denials();

/// A peer has shown that the certificate with this subject is its own. From any thread.
void note_subject(const eprosima::fastrtps::rtps::GuidPrefix_t& peer, std::string subject);

/// What the security plug-ins last logged, to explain a participant or endpoint that could not be
/// made; empty when they logged nothing.
std::string last_security_error();

/// Remembers the peers that did not pass authentication: those that were refused, and those that
/// have not finished it, because they do not accept us or have nothing to show; and those that were
/// denied a topic. Names each by its participant's name, which it chooses itself, and the subject
/// of its certificate: the announced one until note_subject() has the right one.
class RefusalListener : public ReadWithListener {
 public:
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(
      eprosima::fastdds::dds::DomainParticipant* participant,
      eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;

  /// A line for each refusal since the last call: those of this participant, and what this process
  /// denied. Bounded: of a flood the newest remain.
  std::vector<std::string> take();

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::string name;
    std::string subject;  // as announced, empty without a certificate
    Clock::time_point since;
    bool settled = false;  // accepted, or reported already
  };

  // With the mutex locked.
  void report(const eprosima::fastrtps::rtps::GuidPrefix_t& prefix, const std::string& what);
  void report_denials();

  std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, Peer> peers_;
  std::deque<std::string> refusals_;
};

}  // namespace topogeo::messaging
