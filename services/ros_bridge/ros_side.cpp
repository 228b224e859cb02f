#include "ros_side.hpp"

#include <chrono>

#include "topogeo/messaging/plain_participant.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::ros_bridge {
namespace {

messaging::Participant join_ros(const service::Service& service, const Settings& settings,
                                std::uint32_t domain) {
  messaging::ParticipantOptions options;
  options.domain = domain;
  options.name = "/topogeo_bridge";
  options.profile =
      settings.localhost_only ? messaging::kRosLocalhostProfile : messaging::kRosProfile;
  options.profiles_file = service.setup().options.profiles_file;
  return messaging::Participant(options);
}

}  // namespace

RosSide::RosSide(service::Service& service, Settings settings, std::uint32_t domain)
    : service_(service),
      settings_(std::move(settings)),
      participant_(join_ros(service, settings_, domain)) {}

void RosSide::say_once(const std::string& reason, const std::string& detail) {
  constexpr std::size_t kLongestDetail = 512;  // the names in it are as long as a peer chooses
  const std::string text = reason + (detail.empty() ? "" : ": " + detail.substr(0, kLongestDetail));
  complaint_.add(text, support::monotonic_ns());
  if (said_.insert(reason).second) {
    spdlog::warn("{} (logged once, counted in the status)", text);
  }
}

void RosSide::complain(const std::string& reason, const std::string& detail) {
  constexpr std::size_t kLongestReason = 48;
  service_.status().add_drops(reason.substr(0, kLongestReason));
  say_once(reason, detail);
}

void RosSide::set_complaints(const std::string& reason, std::uint64_t count,
                             const std::string& detail) {
  service_.status().set_drops(reason, count);
  if (complaint_.grows(reason, count)) say_once(reason, detail);
}

std::string RosSide::recent_complaint() const {
  return complaint_.text(support::monotonic_ns());
}

}  // namespace topogeo::ros_bridge
