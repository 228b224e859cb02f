// Interface from the server to the service behind it: answers to requests, and driving by hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/support/cpu_time.hpp"

#include "server/route.hpp"

namespace topogeo::web {

inline constexpr std::size_t kLongestPageId = 64;  ///< bytes; see Controls

struct Request {
  bool post = false;        ///< otherwise GET
  std::string path;         ///< "/api/goal"
  std::string query;        ///< part after the question mark, unchanged
  std::string body;         ///< POST only
  bool authorized = false;  ///< has the operator's token; always true for a POST that writes
  std::uint64_t stops = 0;  ///< Backend::stops() when its header was read
  std::string page{};       ///< secret id of the page, see Controls; empty: a program
  bool of_stop = false;     ///< the cancel that belongs to a stop
};

struct Answer {
  unsigned status = 200;  ///< HTTP status
  std::string body;
  std::string content_type = "application/json";
  bool cacheable = false;  ///< permanently: the path of the resource contains its version
};

/// An error in the form of the protocol: {"error": "a sentence"}.
Answer error_answer(unsigned status, const std::string& sentence);

/// Called once, in any thread.
using Respond = std::function<void(Answer)>;

/// Except handle(), all functions are called in the connection thread and return at once.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  /// The route of a request; null when there is none.
  [[nodiscard]] virtual const Route* route(Method method, std::string_view path) const = 0;
  /// Called in the answer thread.
  virtual void handle(const Request& request, Respond respond) = 0;
  /// POST /api/stop and /api/release, with the token. Their answers wait for no other request.
  /// `page`: see Request.
  virtual void stop(const std::string& page, Respond respond) = 0;
  virtual void release_stop(const std::string& page, Respond respond) = 0;
  /// Number of calls of stop() so far.
  [[nodiscard]] virtual std::uint64_t stops() const = 0;
  /// A page of an operator has connected as `viewer`, or has another name. Returns its number, see
  /// Controls.
  virtual std::uint32_t enter(std::uint64_t viewer, const std::string& page,
                              const std::string& name) {
    static_cast<void>(viewer);
    static_cast<void>(page);
    static_cast<void>(name);
    return 0;
  }
  /// The viewer is gone; also called for one that has never entered.
  virtual void leave(std::uint64_t viewer) { static_cast<void>(viewer); }
  /// An operator holds a key or a button. `viewer` is a unique number.
  virtual void drive(std::uint64_t viewer, double linear_mps, double angular_radps) = 0;
  /// The viewer let go or is gone; also called for one that has never driven.
  virtual void release(std::uint64_t viewer) = 0;
};

struct ServerConfig {
  std::string address = "127.0.0.1";
  std::uint32_t port = 0;  ///< 0: any free port
  std::string token;       ///< required for writing; empty: nobody may write
  std::string life;        ///< identifies this run of the service
  std::string robot_id;
  std::vector<std::string> hosts;    ///< names of this machine, see is_own_host
  std::vector<std::string> origins;  ///< further allowed ones, see is_own_origin
  std::string certificate_file;      ///< PEM, with the chain; empty: no TLS
  std::string key_file;              ///< PEM
  std::uint32_t most_viewers = 64;
  /// Seconds from any start, never going back; used by the rate limits.
  std::function<double()> clock_s = support::monotonic_s;
};

}  // namespace topogeo::web
