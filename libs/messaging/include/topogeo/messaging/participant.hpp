// Membership in a DDS domain; writers and readers are made with one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/messaging/discovery.hpp"

namespace topogeo::messaging {

/// Partition of runs that do not name one.
inline constexpr const char* kDefaultPartition = "topogeo";
/// Partition of a reader that receives every run on the domain.
inline constexpr const char* kAnyPartition = "*";

struct ParticipantOptions {
  std::uint32_t domain = 0;                   ///< DDS domain, 0 to 232
  std::string partition = kDefaultPartition;  ///< endpoints of different partitions never match
  std::string name = "topogeo";               ///< shown by DDS tools
  /// Participant profile; empty: TOPOGEO_DDS_PARTICIPANT of the environment, else "topogeo".
  std::string profile;
  /// File of QoS profiles; empty: TOPOGEO_DDS_PROFILES of the environment, else the built-in copy
  /// of deploy/dds_profiles.xml. One process can use one file only.
  std::filesystem::path profiles_file;
  /// Folder with one folder per identity, made by deploy/security/make_keys: certificate,
  /// permissions, encryption. If empty, TOPOGEO_SECURITY of the environment; without either, no
  /// security.
  std::filesystem::path security;
  std::string identity = "topogeo";  ///< its folder there: name of the service or command
  /// Robots that the participant works for; with security its keys must name them. Empty: the
  /// robots of its keys.
  std::vector<std::string> robots;
  bool observe = false;  ///< remembers foreign endpoints for discovered()
};

class ParticipantCore;

class Participant {
 public:
  /// Joins the domain. Throws std::runtime_error when the profiles cannot be loaded, the profile is
  /// unknown, a transport is neither UDP nor shared memory or cannot be opened, the security
  /// material is refused or its keys do not name one of the robots; std::invalid_argument for a
  /// domain over 232.
  explicit Participant(const ParticipantOptions& options = {});

  /// With security: a line for each peer that was refused since the last call and for each access
  /// that a peer was denied.
  [[nodiscard]] std::vector<std::string> take_refusals() const;

  /// How long this process stood still, once that exceeds half the time after which its peers
  /// forget it, or TOPOGEO_LONGEST_FREEZE_S of the environment. Some peers may then have forgotten
  /// the participant, which still takes itself for connected (Fast DDS 2.9.1): those links stay
  /// dead silently, and only a new participant meets all peers again.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> stood_still() const;

  /// The readers and writers of other participants that discovery has announced and not removed;
  /// none without `observe`.
  [[nodiscard]] std::vector<RemoteEndpoint> discovered() const;

  /// Number of other participants that discovery knows, with discovery servers; 0 without
  /// `observe`.
  [[nodiscard]] std::size_t peers() const;

  [[nodiscard]] const std::shared_ptr<ParticipantCore>& core() const { return core_; }

 private:
  std::shared_ptr<ParticipantCore> core_;  // lives until the last writer, reader and loop are gone
};

/// Text of the profiles that are compiled in.
const std::string& built_in_profiles();

}  // namespace topogeo::messaging
