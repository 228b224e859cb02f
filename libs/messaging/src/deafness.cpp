#include "topogeo/messaging/deafness.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "topogeo/messaging/topics.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::messaging {
namespace {

using Status = msg::ServiceStatus;

/// A shorter silence does not count when two statuses are compared.
constexpr double kLeastSilence_s = 5.0;
/// Time before its status that the sender's rate covers: the window of TotalRate, and half a second
/// by which samples of the total may miss its start.
constexpr double kRateWindow_s = 5.5;
/// Peers have met by then, and a first rate covers a whole window.
constexpr double kAcquainted_s = 10.0;
constexpr double kLeastRate_hz = 1.0;
/// Statuses come twice a second, so four were lost.
constexpr double kFresh_s = 2.0;

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

/// An addressed topic may have no messages for one of its readers.
bool is_for_all(std::string_view topic) {
  const auto topics = all_topics();
  const auto found =
      std::ranges::find_if(topics, [&](const auto* known) { return short_name(*known) == topic; });
  return found != topics.end() && (*found)->addressee.empty();
}

bool reports_deafness(const Status& status) {
  return std::ranges::any_of(status.counters(), [](const msg::Counter& counter) {
    return counter.name() == kDeafCounter && counter.value() > 0.0;
  });
}

/// The only other service that sends the topic for the robot; null if there is none, or several.
const HeardStatus* only_sender(std::string_view topic, const Status& reader,
                               std::span<const HeardStatus> all) {
  const HeardStatus* sender = nullptr;
  for (const HeardStatus& one : all) {
    if (one.status->robot_id() != reader.robot_id() ||
        traffic_of(*one.status, topic, true) == nullptr) {
      continue;
    }
    if (sender != nullptr) return nullptr;
    sender = &one;
  }
  return sender == nullptr || sender->status->service() == reader.service() ? nullptr : sender;
}

bool is_alone(const Status& service, std::span<const HeardStatus> all) {
  return std::ranges::count_if(all, [&](const HeardStatus& one) {
           return one.status->service() == service.service() &&
                  one.status->robot_id() == service.robot_id();
         }) == 1;
}

/// The only sender of the topic, while it is at work and the reader is the only one of its kind;
/// otherwise null.
const Status* working_sender(std::string_view topic, const Status& reader,
                             std::span<const HeardStatus> all) {
  const HeardStatus* const sender = only_sender(topic, reader, all);
  const bool known = sender != nullptr && is_alone(reader, all) && works(*sender->status);
  return known ? sender->status : nullptr;
}

double in_seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

double input_silence_s(const Status& service) {
  const std::string topic = service.input().to_string();
  const msg::TopicTraffic* const received = traffic_of(service, topic, false);
  if (!works(service) || received == nullptr || received->waiting() > 0 || !is_for_all(topic)) {
    return 0.0;
  }
  return service.inputs() == 0 ? service.uptime_s() : service.input_age_s();
}

std::string deafness(const HeardStatus& service, std::span<const HeardStatus> all) {
  const Status& status = *service.status;
  const std::string topic = status.input().to_string();
  if (reports_deafness(status)) {
    return fmt::format("deaf: its own status reports that no {} arrives", topic);
  }
  const double silence_s = input_silence_s(status);
  if (silence_s < kLeastSilence_s || !is_alone(status, all) ||
      traffic_of(status, topic, false)->rate_per_s() > 0.0) {
    return {};
  }
  const HeardStatus* const sender = only_sender(topic, status, all);
  if (sender == nullptr || !works(*sender->status)) return {};
  // The messages that the sender counts must all have been sent within the silence.
  if (silence_s + service.age_s - sender->age_s < kRateWindow_s) return {};
  const double rate_per_s = traffic_of(*sender->status, topic, true)->rate_per_s();
  if (rate_per_s < kLeastRate_hz) return {};
  return fmt::format("deaf: none of the {:.1f} {}/s of {} arrives", rate_per_s, topic,
                     sender->status->service().c_str());
}

void DeafnessWatch::hear(const Status& status, Time now) {
  const Name name{status.service().to_string(), status.instance().to_string()};
  if (status.state() == msg::kServiceStopped) {
    peers_.erase(name);
  } else {
    peers_[name] = {status, now};
  }
}

std::vector<HeardStatus> DeafnessWatch::all(const Status& own, const Peers& peers, Time now) {
  std::vector<HeardStatus> all = {{&own, 0.0}};
  for (const auto& [name, peer] : peers) {
    const bool itself = peer.status.service() == own.service() &&
                        peer.status.instance() == own.instance() &&
                        peer.status.started_ns() == own.started_ns();
    const double age_s = in_seconds(now - peer.received);
    if (!itself && age_s <= kFresh_s) all.push_back({&peer.status, age_s});
  }
  return all;
}

bool DeafnessWatch::hears_sender(const Status& own, Time now) const {
  return std::ranges::any_of(all(own, peers_, now), [&](const HeardStatus& one) {
    return one.status != &own && one.status->robot_id() == own.robot_id() &&
           traffic_of(*one.status, own.input().to_string(), true) != nullptr;
  });
}

// The sender's status may count messages that this service handled in one go but has not reported
// yet. So each of its own statuses is compared with the statuses that the others had sent by the
// previous one.
std::string DeafnessWatch::check(const Status& own, Time now) {
  if (own.uptime_s() == own_uptime_s_) return verdict_;
  own_uptime_s_ = own.uptime_s();
  std::erase_if(peers_, [&](const auto& entry) {
    return in_seconds(now - entry.second.received) > kFresh_s;
  });
  // A service that stood still has not missed the messages of that time: they wait for it.
  if (in_seconds(now - known_since_) > kFresh_s) mark_.reset();
  if (input_silence_s(own) < kSilence_s) {
    mark_.reset();
    return verdict_ = {};
  }
  verdict_ = judge(own, all(own, known_, known_since_), all(own, peers_, now));
  known_ = peers_;
  known_since_ = now;
  return verdict_;
}

std::string DeafnessWatch::judge(const Status& own, std::span<const HeardStatus> before,
                                 std::span<const HeardStatus> now) {
  const std::string topic = own.input().to_string();
  const Status* const sent_before = working_sender(topic, own, before);
  const Status* const sends = working_sender(topic, own, now);
  if (sends == nullptr) {
    mark_.reset();
    return {};
  }
  const std::uint64_t received = traffic_of(own, topic, false)->messages();
  if (!mark_ || sent_before == nullptr || mark_->sender != sends->instance().c_str() ||
      mark_->started_ns != sends->started_ns() || mark_->received != received) {
    mark_ = {sends->instance().to_string(), sends->started_ns(), sends->uptime_s(),
             traffic_of(*sends, topic, true)->messages(), received};
    return {};
  }
  const std::uint64_t sent = traffic_of(*sent_before, topic, true)->messages();
  const double passed_s = sent_before->uptime_s() - mark_->uptime_s;
  if (passed_s < kProof_s || sent < mark_->sent + kProofMessages) return {};
  return fmt::format("none of the {} {} that {} has sent in {:.1f} s has arrived",
                     sent - mark_->sent, topic, sent_before->service().c_str(), passed_s);
}

}  // namespace topogeo::messaging
