// Detects a deaf service: it gets nothing of its main input although another service sends it,
// because one of the two forgot the other after an interruption that only one side noticed.
//
// Both checks use only the statuses of the two services, so neither a robot that stands still nor a
// slow or frozen machine makes a service deaf. `topogeo status` and `topogeo doctor` see two
// statuses and judge at once (deafness); a service that is about to end itself waits for proof
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

/// Why `service` is deaf: "deaf: none of the 5.1 scan/s of sensor_gateway arrives". Empty if it is
/// not, or if its status does not show it. A service is deaf if its own status says so, or if its
/// main input has been silent for 5 s with nothing left to handle while the only sender sent at
/// least one message a second. `all`: the services of its domain and partition that publish their
/// status now. If two of them do the same job for the robot, the result is empty.
[[nodiscard]] std::string deafness(const HeardStatus& service, std::span<const HeardStatus> all);

/// How long the main input of a service has been silent, by its status; since its start if nothing
/// ever came. 0 s if the service is not at work, or if its main input is not a topic that all its
/// readers get.
[[nodiscard]] double input_silence_s(const msg::ServiceStatus& service);

/// Gathers the proof that a service is deaf: within a silence of its main input the only sender, by
/// its own count and its own clock, has sent three messages or more in 5 s, and a later status of
/// the service counts none of them. The proof begins when the input has been silent for 3 s, so no
/// service is deaf in less than 8 s. The caller passes the time, which never goes back.
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

  /// Whether statuses of a sender of the main input arrive. If not, deafness cannot be judged: the
  /// sender is gone or frozen, or none of its messages arrive at all.
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

  /// The service itself, by its own status, and the peers that were heard lately.
  [[nodiscard]] static std::vector<HeardStatus> all(const msg::ServiceStatus& own,
                                                    const Peers& peers, Time now);
  /// `before`: the statuses of all at the time of the previous status of the service.
  [[nodiscard]] std::string judge(const msg::ServiceStatus& own,
                                  std::span<const HeardStatus> before,
                                  std::span<const HeardStatus> now);

  Peers peers_;
  double own_uptime_s_ = -1.0;  // of the service's status that was judged last
  Peers known_;                 // the other services at that time
  Time known_since_;
  std::string verdict_;
  std::optional<Mark> mark_;  // where the proof begins
};

}  // namespace topogeo::messaging
