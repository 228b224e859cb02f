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

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "read_with.hpp"

namespace topogeo::messaging {

/// Turns authentication, access control and encryption on, with the files that
/// deploy/security/make_keys writes into `folder`. Throws std::runtime_error that names the missing
/// file, or if ROS_DISCOVERY_SERVER is set: Fast DDS 2.9 has no security there, and participants
/// would silently find no peers, or with Fast DDS 3 (corrections.hpp).
void add_security(eprosima::fastdds::dds::DomainParticipantQos& qos,
                  const std::filesystem::path& folder);

/// Lets a participant, writer or reader use a session key for 16 MB instead of 512 bytes: making
/// one takes longer than encrypting a message. The random part of the initialization vector has 64
/// bits, so two of the million messages of a key have the same one with a probability of 3e-8 (NIST
/// SP 800-38D, chapter 8).
void use_long_sessions(rtps::PropertyPolicy& properties);

/// Does nothing, but a call links the fixes of security_races.cpp into the program.
void keep_security_races_away();

/// A peer's writer or reader that security does not let connect to ours, or one of its samples.
struct Denial {
  rtps::GuidPrefix_t peer;
  std::string topic;
  bool writer = false;
  bool other_governance = false;  // its protection differs from the topic's here
  std::string robot = {};         // of the sample; empty: the whole writer or reader is denied
};

/// Adds a denial to the next report of this process's RefusalListener. Thread-safe.
void note_denial(Denial denial);

/// Does nothing, but a call links the checks of security_denials.cpp into the program.
void note_denials();

/// Records the proven certificate subject of a peer. Thread-safe.
void note_subject(const rtps::GuidPrefix_t& peer, std::string subject);

/// The last message of the security plug-ins, to explain why a participant or endpoint could not be
/// made; empty when they logged nothing.
std::string last_security_error();

/// Remembers peers that were refused, that did not finish authentication (they do not accept us or
/// have nothing to show) or that were denied a topic. Names each by its participant's name, which
/// the peer chooses itself, and by the subject of its certificate: the announced one until
/// note_subject() has the right one.
class RefusalListener : public ReadWithListener {
 public:
  void on_peer(const DiscoveredPeer& peer) override;
  void on_authentication(const rtps::GuidPrefix_t& peer, bool authorized) override;

  /// A line for each refusal since the last call, by this participant or, for denials, by this
  /// process. Bounded: a flood leaves only the newest.
  std::vector<std::string> take();

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::string name;
    std::string subject;  // as announced, empty without a certificate
    Clock::time_point since;
    bool settled = false;  // accepted, or reported already
  };

  // The mutex is locked.
  void report(const rtps::GuidPrefix_t& prefix, const std::string& what);
  void report_denials();

  std::mutex mutex_;
  std::map<rtps::GuidPrefix_t, Peer> peers_;
  std::deque<std::string> refusals_;
};

}  // namespace topogeo::messaging
