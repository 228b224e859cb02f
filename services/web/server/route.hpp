// A route of the HTTP interface, as far as the server must know it before it reads the body.
#pragma once

#include <cstdint>
#include <string_view>

namespace topogeo::web {

enum class Method : std::uint8_t { kGet, kPost };

/// The senders whose requests are answered.
enum class Access : std::uint8_t { kAnybody, kOperator };

/// The function of Backend that answers, and its thread.
enum class Handling : std::uint8_t {
  kStop,     ///< stop(), in the connection thread, with the rate limit of stops
  kRelease,  ///< release_stop(), likewise
  kAtOnce,   ///< handle(), in the answer thread
  kInLoop,   ///< handle(), which passes the request to the loop of the service
};

inline constexpr std::uint64_t kNoBody_bytes = 0;
/// Also the limit for a POST without a route.
inline constexpr std::uint64_t kMostBody_bytes = 65536;
/// A drawing of the largest size, with all digits of each number.
inline constexpr std::uint64_t kMostDrawing_bytes = std::uint64_t{8} << 20U;
inline constexpr std::uint64_t kMostMapFile_bytes = std::uint64_t{64} << 20U;

struct Route {
  Method method;
  std::string_view path;  ///< without the query; one that ends in '/' includes all paths below it
  Access access;
  std::uint64_t most_body_bytes;
  Handling handling;
  std::string_view help;        ///< for docs/web_protocol.md
  bool needs_controls = false;  ///< of a page, see Controls
};

}  // namespace topogeo::web
