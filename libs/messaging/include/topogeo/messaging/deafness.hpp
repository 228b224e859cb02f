// A service that gets nothing of its main input although another service sends it: one of the two
// has forgotten the other, after an interruption that only one side has noticed.
//
// Both judgements go by what the two services report alone, so that neither a robot that stands nor
// a machine that is slow or frozen makes a service deaf. `topogeo status` and `topogeo doctor` see
// two statuses and judge at once (deafness); a service that is about to end itself waits for proof
// (DeafnessWatch).
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/msg/status.h"

namespace topogeo::messaging {

/// Counter of a status: 1 while the service itself finds that it is deaf, else 0.
inline constexpr const char* kDeafCounter = "deaf";

/// The last status of a service, and how long ago it came (>= 0 s).
struct HeardStatus {
  const msg::ServiceStatus* status = nullptr;
  double age_s = 0.0;
};

/// Why `service` is deaf: "deaf: none of the 5.1 scan/s of sensor_gateway arrives". Empty: it is
/// not, or its status does not show it. Deaf is one whose status says so, and one of whose main
/// input nothing has arrived for 5 s and nothing waits to be handled, while the only sender has
/// sent one a second or more in that time. `all`: those of its domain and partition that publish
/// their status now. Where two of them do the same for the robot, nothing is decided.
[[nodiscard]] std::string deafness(const HeardStatus& service, std::span<const HeardStatus> all);

/// How long nothing of its main input has come to a service, by its status: since it began where
/// none ever came. 0 s for one that is not at work, or whose main input is no topic that all its
/// readers get.
[[nodiscard]] double input_silence_s(const msg::ServiceStatus& service);

/// Gathers the proof that a service is deaf: within a silence of its main input the only sender, by
/// its own count and its own clock, has sent three messages or more in 5 s, and a later status of
/// the service counts none of them. The proof begins when the input has been silent for 3 s, so
/// that nobody is deaf in less than 8 s. The caller passes the time, which never goes back.
class DeafnessWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr double kSilence_s = 3.0;
  static constexpr double kProof_s = 5.0;
  static constexpr std::uint64_t kProofMessages = 3;

  /// A status of any service of the domain and partition has come.
  void hear(const msg::ServiceStatus& status, Time now);

  /// The service with that status is at work. Returns why it is deaf: "none of the 51 scan that
  /// sensor_gateway has sent in 5.1 s has arrived"; empty while there is no proof.
  [[nodiscard]] std::string check(const msg::ServiceStatus& own, Time now);

  /// Whether the status of a sender of the main input comes in. Without it nothing is known: the
  /// sender is gone or frozen, or no message of it arrives at all.
  [[nodiscard]] bool hears_sender(const msg::ServiceStatus& own, Time now) const;

 private:
  using Name = std::pair<std::string, std::string>;  // service, instance
  struct Peer {
    msg::ServiceStatus status;
    Time received;
  };
  using Peers = std::map<Name, Peer>;
  struct Mark {
    std::string sender;  // its instance
    std::int64_t started_ns = 0;
    double uptime_s = 0.0;
    std::uint64_t sent = 0;
    std::uint64_t received = 0;  // by the service itself
  };

  /// The service itself, as it knows itself, and the peers that were heard lately.
  [[nodiscard]] static std::vector<HeardStatus> all(const msg::ServiceStatus& own,
                                                    const Peers& peers, Time now);
  /// `before`: the statuses of all at the time of the previous status of the service.
  [[nodiscard]] std::string judge(const msg::ServiceStatus& own,
                                  std::span<const HeardStatus> before,
                                  std::span<const HeardStatus> now);

  Peers peers_;
  double own_uptime_s_ = -1.0;  // of the status of the service that was judged last
  Peers known_;                 // the others, when it was
  Time known_since_;
  std::string verdict_;
  std::optional<Mark> mark_;  // where the proof begins
};

}  // namespace topogeo::messaging
