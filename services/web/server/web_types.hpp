// What the server asks of the service behind it: answers to requests, and driving by hand.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::web {

/// A map file may be sent to it, in the form of `map.pb`.
inline constexpr std::string_view kMapUploadPath = "/api/merge_map";
inline constexpr std::uint64_t kMostMapFile_bytes = std::uint64_t{64} << 20U;

struct Request {
  bool post = false;        ///< else GET
  std::string path;         ///< "/api/goal"
  std::string query;        ///< what follows the question mark, as it came
  std::string body;         ///< of POST
  bool authorized = false;  ///< has the operator's token; of POST that writes always
};

struct Answer {
  unsigned status = 200;  ///< of HTTP
  std::string body;
  std::string content_type = "application/json";
  bool cacheable = false;  ///< for good: the resource has its version in its name
};

/// An error as the protocol has it: {"error": "a sentence"}.
Answer error_answer(unsigned status, const std::string& sentence);

/// Called once, in any thread.
using Respond = std::function<void(Answer)>;

/// All but handle() are called in the thread of the connections, and come back at once.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  /// In the thread of the answers.
  virtual void handle(const Request& request, Respond respond) = 0;
  /// POST /api/stop and /api/release, with the token. Their answers wait for no other request.
  virtual void stop(Respond respond) = 0;
  virtual void release_stop(Respond respond) = 0;
  /// An operator holds key or finger. `viewer` is a number that no other has had.
  virtual void drive(std::uint64_t viewer, double linear_mps, double angular_radps) = 0;
  /// Let go, or gone; also for one that has never driven.
  virtual void release(std::uint64_t viewer) = 0;
};

inline double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct ServerConfig {
  std::string address = "127.0.0.1";
  std::uint32_t port = 0;  ///< 0: any that is free
  std::string token;       ///< for writing; empty: nobody may
  std::string life;        ///< another one after each start
  std::string robot_id;
  std::vector<std::string> hosts;    ///< names of this machine, see is_own_host
  std::vector<std::string> origins;  ///< further ones, see is_own_origin
  std::string certificate_file;      ///< PEM, with the chain; empty: no TLS
  std::string key_file;              ///< PEM
  std::uint32_t most_viewers = 64;
  /// Seconds since any start, never backwards: how often a peer may ask is counted by it.
  std::function<double()> clock_s = steady_s;
};

}  // namespace topogeo::web
