#include "server/viewer_message.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "server/bounded_json.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {
namespace {

using Op = ViewerMessage::Op;

Op op_of(const std::string& name) {
  if (name == "hello") return Op::kHello;
  if (name == "channels") return Op::kWant;
  if (name == "resync") return Op::kResync;
  if (name == "ping") return Op::kPing;
  if (name == "drive") return Op::kDrive;
  if (name == "release") return Op::kRelease;
  if (name == "stop") return Op::kStop;
  throw std::invalid_argument(
      "op: expected hello, channels, resync, ping, drive, release or stop, not '" + name + "'");
}

std::string text_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return {};
  if (!found->is_string()) throw std::invalid_argument(std::string(key) + ": expected a text");
  return found->get<std::string>();
}

double number_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
    throw std::invalid_argument(std::string(key) + ": expected a number");
  }
  return found->get<double>();
}

void take_channels(const Json& json, ViewerMessage& message) {
  const auto found = json.find("channels");
  if (found == json.end()) return;
  if (!found->is_array()) throw std::invalid_argument("channels: expected a list of names");
  message.all_channels = false;
  for (const Json& name : *found) {
    if (!name.is_string()) throw std::invalid_argument("channels: expected a list of names");
    if (const auto channel = channel_of(name.get<std::string>())) {
      message.channels.push_back(*channel);
    }
  }
}

void take_held(const Json& json, ViewerMessage& message) {
  const auto found = json.find("have");
  if (found == json.end()) return;
  if (!found->is_object()) throw std::invalid_argument("have: expected versions by channel");
  for (const auto& [name, version] : found->items()) {
    const std::optional<Channel> channel = channel_of(name);
    if (!version.is_number_unsigned()) {
      throw std::invalid_argument("have: expected versions by channel");
    }
    if (channel) message.have[*channel] = version.get<std::uint64_t>();
  }
}

}  // namespace

ViewerMessage parse_viewer_message(std::string_view text) {
  const Json json = object_of(text);
  ViewerMessage message;
  message.op = op_of(text_at(json, "op"));
  if (json.contains("page_ms")) message.page_ms = number_at(json, "page_ms");
  switch (message.op) {
    case Op::kHello:
      message.token = text_at(json, "token");
      message.life = text_at(json, "life");
      message.page = text_at(json, "page");
      message.name = text_at(json, "name");
      if (message.page.size() > kLongestPageId) {
        throw std::invalid_argument("page: expected at most 64 bytes");
      }
      take_held(json, message);
      take_channels(json, message);
      break;
    case Op::kWant:
      take_channels(json, message);
      if (message.all_channels) throw std::invalid_argument("channels: expected a list of names");
      break;
    case Op::kResync: {
      const auto channel = channel_of(text_at(json, "channel"));
      if (!channel) throw std::invalid_argument("channel: expected the name of one");
      message.channel = *channel;
      break;
    }
    case Op::kDrive:
      message.linear_mps = number_at(json, "linear_mps");
      message.angular_radps = number_at(json, "angular_radps");
      message.page_ms = number_at(json, "page_ms");
      break;
    case Op::kPing:
    case Op::kRelease:
    case Op::kStop:
      break;
  }
  return message;
}

}  // namespace topogeo::web
