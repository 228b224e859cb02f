#include "foxglove/foxglove_viewer.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "topogeo/support/host.hpp"
#include "topogeo/support/version.hpp"

#include "foxglove/foxglove_feed.hpp"
#include "foxglove/foxglove_scene.hpp"
#include "server/access.hpp"
#include "server/bounded_json.hpp"

namespace topogeo::web {
namespace {

constexpr int kWarningStatus = 1;
constexpr int kErrorStatus = 2;

std::string status(int level, const std::string& sentence) {
  return text_of(Json{{"op", "status"}, {"level", level}, {"message", sentence}});
}

std::uint32_t id_of(const Json& json, const std::string& name) {
  if (!json.is_number_unsigned() ||
      json.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument(name + ": expected a number from 0 to 4294967295");
  }
  return json.get<std::uint32_t>();
}

const Json& list_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array()) {
    throw std::invalid_argument(std::string(key) + ": expected a list");
  }
  return *found;
}

const Json& member(const Json& json, const char* key) {
  static const Json kNothing;
  if (!json.is_object()) return kNothing;
  const auto found = json.find(key);
  return found == json.end() ? kNothing : *found;
}

Watcher::Frame frame_of(std::string bytes) {
  return {std::make_shared<const std::string>(std::move(bytes)), true};
}

Watcher::Made live_frames(std::uint32_t id, const LiveMessage& message) {
  return {{frame_of(message_data(id, message.time_ns, *message.json))}, message.version};
}

Watcher::Made hub_frames(std::uint32_t id, Channel channel, const Update& update) {
  const std::int64_t now_ns = support::wall_clock_ns();
  Watcher::Made made;
  made.version = update.version;
  for (const std::string& payload : foxglove_messages(channel, *update.text, now_ns)) {
    made.frames.push_back(frame_of(message_data(id, now_ns, payload)));
  }
  return made;
}

template <class Number>
void append_little_endian(std::string& bytes, Number value) {
  constexpr unsigned kByte = 0xffU;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>((value >> (8U * i)) & kByte);
  }
}

}  // namespace

std::string foxglove_subprotocol(std::string_view offered) {
  std::string chosen;
  for (const std::string_view name : names_in(offered)) {
    if (name == "foxglove.sdk.v1") return std::string(name);
    if (name == "foxglove.websocket.v1") chosen = name;
  }
  return chosen;
}

std::string message_data(std::uint32_t subscription, std::int64_t time_ns,
                         std::string_view payload) {
  constexpr char kMessageData = 1;
  std::string bytes(1, kMessageData);
  append_little_endian(bytes, subscription);
  append_little_endian(bytes, static_cast<std::uint64_t>(time_ns));
  return bytes.append(payload);
}

void FoxgloveViewer::on_open() {
  const ServerConfig& config = state().config;
  control(text_of(Json{{"op", "serverInfo"},
                       {"name", "topogeo: " + config.robot_id},
                       {"capabilities", Json::array()},
                       {"supportedEncodings", Json::array()},
                       {"metadata", {{"version", support::kVersion}}},
                       {"sessionId", config.life}}));
  control(advertisement());
  pump();
}

void FoxgloveViewer::on_text(const std::string& text) {
  const Json message = parse_bounded(text);
  try {
    if (!message.is_object()) throw std::invalid_argument("expected a JSON object");
    const Json& op = member(message, "op");
    if (op == "subscribe") {
      subscribe(message);
    } else if (op == "unsubscribe") {
      unsubscribe(message);
    } else {
      throw std::invalid_argument("this service does not offer the operation " + text_of(op));
    }
  } catch (const std::invalid_argument& error) {
    refuse("no message", error.what());
  }
  pump();
}

void FoxgloveViewer::subscribe(const Json& message) {
  for (const Json& wanted : list_at(message, "subscriptions")) {
    const std::uint32_t id = id_of(member(wanted, "id"), "id");
    const std::uint32_t channel_id = id_of(member(wanted, "channelId"), "channelId");
    const FoxgloveTopic* const topic = foxglove_topic(channel_id);
    if (topic == nullptr) {
      throw std::invalid_argument("there is no channel " + std::to_string(channel_id));
    }
    const bool known = subscriptions_.contains(id) ||
                       std::ranges::any_of(subscriptions_, [&](const auto& subscription) {
                         return subscription.second.topic == topic;
                       });
    if (known) {
      control(status(kWarningStatus, "subscription " + std::to_string(id) + " to channel " +
                                         std::to_string(channel_id) +
                                         ": expected another id, and one for each channel"));
    } else {
      subscriptions_.emplace(id, Subscription{topic});
    }
  }
}

void FoxgloveViewer::unsubscribe(const Json& message) {
  for (const Json& number : list_at(message, "subscriptionIds")) {
    const std::uint32_t id = id_of(number, "subscriptionIds");
    if (subscriptions_.erase(id) == 0) {
      control(status(kWarningStatus, "there is no subscription " + std::to_string(id)));
    }
    if (id == frames_of_) {
      drop_frames();
      frames_of_.reset();
    }
  }
}

std::string FoxgloveViewer::refusal(const std::string& sentence, std::string_view) const {
  return status(kErrorStatus, sentence);
}

std::uint64_t FoxgloveViewer::version_of(const FoxgloveTopic& topic) const {
  return topic.live ? state().feed.version(*topic.live) : state().hub.version(*topic.channel);
}

bool FoxgloveViewer::is_due(const Subscription& subscription) const {
  const FoxgloveTopic& topic = *subscription.topic;
  if (version_of(topic) == subscription.held) return false;
  return subscription.turn == 0 ||
         state().config.clock_s() - subscription.sent_s >= topic.shortest_period_s;
}

Watcher::Work FoxgloveViewer::next_work() {
  const auto before = [](const auto& a, const auto& b) { return a.second.turn < b.second.turn; };
  auto next = subscriptions_.end();
  for (auto it = subscriptions_.begin(); it != subscriptions_.end(); ++it) {
    if (is_due(it->second) && (next == subscriptions_.end() || before(*it, *next))) next = it;
  }
  if (next == subscriptions_.end()) return {};
  auto& [id, subscription] = *next;
  frames_of_ = id;
  subscription.turn = ++messages_sent_;
  subscription.sent_s = state().config.clock_s();
  if (subscription.topic->live) {
    return [id = id, &feed = state().feed, topic = *subscription.topic->live] {
      return live_frames(id, feed.newest(topic));
    };
  }
  return [id = id, &hub = state().hub, channel = *subscription.topic->channel,
          held = subscription.held] { return hub_frames(id, channel, hub.update(channel, held)); };
}

void FoxgloveViewer::on_made(std::uint64_t version) {
  if (frames_of_) {
    subscriptions_.at(*frames_of_).held = version;
  } else {
    drop_frames();
  }
}

}  // namespace topogeo::web
