// The table of all routes: routing, body limits, rights, the offers in /api/info and a table of
// docs/web_protocol.md derive from it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "server/route.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class WebService;

/// Whether /api/info lists the order.
enum class Offer : std::uint8_t { kNever, kAlways, kWithSimulator };

/// Whether the order is refused if the robot was stopped after its header had arrived.
enum class AfterStop : std::uint8_t { kObeyed, kRefused };

struct ServiceRoute {
  Route route;
  Offer offer;
  AfterStop after_stop;
  /// Called in the answer thread or in the loop, see Handling. Throws std::invalid_argument for a
  /// malformed request.
  void (*handler)(WebService& web, const Request& request, const Respond& respond);
};

/// Folder of all orders and of most resources.
inline constexpr std::string_view kApi = "/api/";
/// Orders that a stop and its release pass to the loop.
inline constexpr std::string_view kCancelPath = "/api/cancel";
inline constexpr std::string_view kReleasePath = "/api/release";
inline constexpr std::string_view kStopPath = "/api/stop";

std::span<const ServiceRoute> service_routes();

/// Null when there is no such route.
const ServiceRoute* find_route(Method method, std::string_view path);

}  // namespace topogeo::web
