#include "server/channel_hub.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

struct ChannelInfo {
  std::string_view name;
  bool table;
};

constexpr std::array<ChannelInfo, kChannels> kInfo = {{
    {"time", false},  {"pose", false},      {"drive", false},   {"navigator", false},
    {"base", false},  {"goals", false},     {"map", false},     {"tiles", true},
    {"rooms", true},  {"places", true},     {"rules", true},    {"drawing", false},
    {"scan", false},  {"route", false},     {"truth", false},   {"laser", false},
    {"trail", true},  {"graph", true},      {"services", true}, {"workers", true},
    {"merges", true}, {"local_map", false}, {"search", false},  {"loops", true},
    {"events", true}, {"alarms", true},     {"viewers", false}, {"controls", false},
}};

/// A text in quotes.
std::string quoted(const std::string& text) {
  return text_of(Json(text));
}

std::string head(Channel channel) {
  return R"({"channel":")" + std::string(name_of(channel)) + '"';
}

}  // namespace

std::string_view name_of(Channel channel) {
  return kInfo.at(static_cast<std::size_t>(channel)).name;
}

std::optional<Channel> channel_of(std::string_view name) {
  const auto found = std::ranges::find(kInfo, name, &ChannelInfo::name);
  if (found == kInfo.end()) return std::nullopt;
  return static_cast<Channel>(std::distance(kInfo.begin(), found));
}

bool is_table(Channel channel) {
  return kInfo.at(static_cast<std::size_t>(channel)).table;
}

void ChannelHub::on_change(std::function<void(Channel)> handler) {
  const std::scoped_lock lock(mutex_);
  on_change_ = std::move(handler);
}

void ChannelHub::report(Channel channel) {
  std::function<void(Channel)> handler;
  {
    const std::scoped_lock lock(mutex_);
    handler = on_change_;
  }
  if (handler) handler(channel);
}

void ChannelHub::set(Channel channel, std::string json) {
  {
    const std::scoped_lock lock(mutex_);
    State& now = state(channel);
    now.set_s = clock_s_();
    if (now.version > 0 && !now.make_value && now.value == json) return;
    now.value = std::move(json);
    now.make_value = nullptr;
    ++now.version;
    now.texts.clear();
    show_version(channel);
  }
  report(channel);
}

void ChannelHub::set_later(Channel channel, std::function<std::string()> make) {
  {
    const std::scoped_lock lock(mutex_);
    State& now = state(channel);
    now.set_s = clock_s_();
    now.make_value = std::move(make);
    ++now.version;
    now.texts.clear();
    show_version(channel);
  }
  report(channel);
}

std::string ChannelHub::ages_s() const {
  const std::scoped_lock lock(mutex_);
  const double now_s = clock_s_();
  Json ages = Json::object();
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto channel = static_cast<Channel>(i);
    if (channel == Channel::kTime || is_table(channel) || states_.at(i).version == 0) continue;
    ages[std::string(name_of(channel))] = rounded(now_s - states_.at(i).set_s);
  }
  return text_of(ages);
}

void ChannelHub::edit(Channel channel, std::vector<Edit> edits, bool anew) {
  {
    const std::scoped_lock lock(mutex_);
    if (!apply(state(channel), edits, anew)) return;
    show_version(channel);
  }
  report(channel);
}

bool ChannelHub::apply(State& state, std::vector<Edit>& edits, bool anew) {
  if (anew) {
    std::set<std::string_view> kept;
    for (const Edit& edit : edits) kept.insert(edit.key);
    std::vector<Edit> removals;
    for (const auto& [key, object] : state.objects) {
      if (!kept.contains(key)) removals.push_back({key, {}});
    }
    std::ranges::move(removals, std::back_inserter(edits));
  }
  bool changed = state.version == 0;  // an empty table differs from a missing one
  const std::uint64_t version = state.version + 1;
  for (Edit& edit : edits) {
    const auto held = state.objects.find(edit.key);
    if (edit.json.empty()) {
      if (held == state.objects.end()) continue;
      state.objects.erase(held);
      state.gone.emplace_back(version, std::move(edit.key));
    } else {
      if (held != state.objects.end() && held->second.json == edit.json) continue;
      state.objects.insert_or_assign(std::move(edit.key), Object{std::move(edit.json), version});
    }
    changed = true;
  }
  if (!changed) return false;
  state.version = version;
  state.texts.clear();
  while (state.gone.size() > kRemembered) {
    state.forgotten = state.gone.front().first;
    state.gone.pop_front();
  }
  return true;
}

std::uint64_t ChannelHub::version(Channel channel) const {
  return versions_.at(static_cast<std::size_t>(channel));
}

void ChannelHub::show_version(Channel channel) {
  versions_.at(static_cast<std::size_t>(channel)) = state(channel).version;
}

Update ChannelHub::update(Channel channel, std::uint64_t held) const {
  constexpr std::size_t kKept = 8;
  const std::scoped_lock lock(mutex_);
  const State& now = state(channel);
  const bool known = is_table(channel) && held <= now.version && held >= now.forgotten;
  const std::uint64_t from = known ? held : 0;
  auto made = now.texts.find(from);
  if (made == now.texts.end()) {
    if (now.texts.size() >= kKept) now.texts.clear();
    made = now.texts.emplace(from, std::make_shared<const std::string>(text(channel, now, from)))
               .first;
  }
  return {made->second, now.version};
}

std::string ChannelHub::text(Channel channel, const State& state, std::uint64_t from) {
  std::string out = head(channel);
  if (!is_table(channel)) {
    if (state.make_value) state.value = std::exchange(state.make_value, nullptr)();
    return out + R"(,"version":)" + std::to_string(state.version) + R"(,"value":)" + state.value +
           '}';
  }
  out += R"(,"from":)" + std::to_string(from) + R"(,"version":)" + std::to_string(state.version) +
         R"(,"set":{)";
  const char* comma = "";
  for (const auto& [key, object] : state.objects) {
    if (object.version <= from) continue;
    out += comma + quoted(key) + ':' + object.json;
    comma = ",";
  }
  out += R"(},"gone":[)";
  comma = "";
  std::set<std::string_view> named;
  for (auto gone = state.gone.rbegin(); from > 0 && gone != state.gone.rend(); ++gone) {
    if (gone->first <= from) break;
    if (state.objects.contains(gone->second) || !named.insert(gone->second).second) continue;
    out += comma + quoted(gone->second);
    comma = ",";
  }
  return out + "]}";
}

}  // namespace topogeo::web
