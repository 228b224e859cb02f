#include "deafness.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "topogeo/messaging/topics.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

using Status = msg::ServiceStatus;

/// Rates are means over as long.
constexpr double kSilence_s = 5.0;
/// Peers have met by then, and a first rate is over a whole window.
constexpr double kAcquainted_s = 10.0;
constexpr double kLeastRate_hz = 1.0;

const msg::TopicTraffic* traffic_of(const Status& status, std::string_view topic, bool sent) {
  const auto found = std::ranges::find_if(status.traffic(), [&](const msg::TopicTraffic& one) {
    return one.sent() == sent && one.topic().to_string() == topic;
  });
  return found == status.traffic().end() ? nullptr : &*found;
}

bool works(const Status& status) {
  const bool at_work =
      status.state() == msg::kServiceRunning || status.state() == msg::kServiceWaiting;
  return at_work && status.uptime_s() >= kAcquainted_s;
}

/// A topic whose messages are for some of its readers alone may give one of them none.
bool is_for_all(std::string_view topic) {
  const auto topics = messaging::all_topics();
  const auto found = std::ranges::find_if(
      topics, [&](const auto* known) { return messaging::short_name(*known) == topic; });
  return found != topics.end() && (*found)->addressee.empty();
}

/// The status of the only service that sends the topic for the robot; null where there is none, or
/// several.
const Status* only_sender(std::string_view topic, const Status& reader,
                          std::span<const Status* const> all) {
  const Status* sender = nullptr;
  for (const Status* one : all) {
    if (one->robot_id() != reader.robot_id() || traffic_of(*one, topic, true) == nullptr) continue;
    if (sender != nullptr) return nullptr;
    sender = one;
  }
  return sender;
}

bool is_alone(const Status& service, std::span<const Status* const> all) {
  return std::ranges::count_if(all, [&](const Status* one) {
           return one->service() == service.service() && one->robot_id() == service.robot_id();
         }) == 1;
}

}  // namespace

std::string deafness(const Status& service, std::span<const Status* const> all) {
  const std::string topic = service.input().to_string();
  const msg::TopicTraffic* const received = traffic_of(service, topic, false);
  if (!works(service) || received == nullptr || received->rate_per_s() > 0.0 ||
      received->waiting() > 0 || service.input_age_s() < kSilence_s || !is_for_all(topic) ||
      !is_alone(service, all)) {
    return {};
  }
  const Status* const sender = only_sender(topic, service, all);
  if (sender == nullptr || !works(*sender)) return {};
  const double rate_per_s = traffic_of(*sender, topic, true)->rate_per_s();
  if (rate_per_s < kLeastRate_hz) return {};
  return fmt::format("deaf: none of the {:.1f} {}/s of {} arrives", rate_per_s, topic,
                     sender->service().c_str());
}

}  // namespace topogeo::cli
