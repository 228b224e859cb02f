#include "server/channel_hub.hpp"

#include <map>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace topogeo::web {
namespace {

using nlohmann::json;

json message(const ChannelHub& hub, Channel channel, std::uint64_t held) {
  return json::parse(*hub.update(channel, held).text);
}

TEST(ChannelHub, AValueReplacesTheOneBefore) {
  ChannelHub hub;
  EXPECT_EQ(hub.version(Channel::kPose), 0U);
  hub.set(Channel::kPose, R"({"x_m":1})");
  hub.set(Channel::kPose, R"({"x_m":2})");
  EXPECT_EQ(message(hub, Channel::kPose, 0),
            json::parse(R"({"channel":"pose","version":2,"value":{"x_m":2}})"));
}

TEST(ChannelHub, AValueThatIsSetAgainIsNewThoughItIsEqual) {
  double now_s = 100.0;
  ChannelHub hub([&] { return now_s; });
  hub.set(Channel::kBase, "1");
  hub.set(Channel::kPose, "1");
  hub.set(Channel::kTime, "1");
  hub.edit(Channel::kGraph, {{"n1", "{}"}});
  now_s += 120.0;
  hub.set(Channel::kBase, "1");
  now_s += 0.5;
  EXPECT_EQ(json::parse(hub.ages_s()), json::parse(R"({"pose":120.5,"base":0.5})"));
  EXPECT_EQ(hub.version(Channel::kBase), 1U);
}

TEST(ChannelHub, AValueForLaterIsMadeOnceAndOnlyWhenItIsAskedFor) {
  double now_s = 100.0;
  ChannelHub hub([&] { return now_s; });
  int made = 0;
  int changes = 0;
  hub.on_change([&](Channel) { ++changes; });
  for (int i = 0; i < 3; ++i) {
    hub.set_later(Channel::kScan, [&made, i] {
      ++made;
      return std::to_string(i);
    });
  }
  now_s += 2.0;
  EXPECT_EQ(made, 0);
  EXPECT_EQ(changes, 3);
  EXPECT_EQ(json::parse(hub.ages_s()), json::parse(R"({"scan":2.0})"));
  for (const std::uint64_t held : {0U, 2U}) {
    EXPECT_EQ(message(hub, Channel::kScan, held),
              json::parse(R"({"channel":"scan","version":3,"value":2})"));
  }
  EXPECT_EQ(made, 1);
  hub.set_later(Channel::kScan, [] { return std::string("7"); });
  hub.set(Channel::kScan, "2");
  EXPECT_EQ(message(hub, Channel::kScan, 0)["value"], 2);
}

TEST(ChannelHub, WhatIsEqualIsNoChange) {
  ChannelHub hub;
  int changes = 0;
  hub.on_change([&](Channel) { ++changes; });
  hub.set(Channel::kPose, "1");
  hub.set(Channel::kPose, "1");
  hub.edit(Channel::kGraph, {{"n1", "{}"}});
  hub.edit(Channel::kGraph, {{"n1", "{}"}, {"n7", ""}});
  EXPECT_EQ(changes, 2);
  EXPECT_EQ(hub.version(Channel::kGraph), 1U);
}

TEST(ChannelHub, ADeltaHasWhatChangedSinceAVersion) {
  ChannelHub hub;
  hub.edit(Channel::kGraph, {{"n1", "1"}, {"n2", "2"}, {"n3", "3"}});
  hub.edit(Channel::kGraph, {{"n2", "20"}});
  hub.edit(Channel::kGraph, {{"n3", ""}});
  EXPECT_EQ(
      message(hub, Channel::kGraph, 1),
      json::parse(R"({"channel":"graph","from":1,"version":3,"set":{"n2":20},"gone":["n3"]})"));
  EXPECT_EQ(
      message(hub, Channel::kGraph, 0),
      json::parse(R"({"channel":"graph","from":0,"version":3,"set":{"n1":1,"n2":20},"gone":[]})"));
}

TEST(ChannelHub, WhatIsGoneAndThereAgainIsThere) {
  ChannelHub hub;
  hub.edit(Channel::kGraph, {{"n1", "1"}});
  hub.edit(Channel::kGraph, {{"n1", ""}});
  hub.edit(Channel::kGraph, {{"n1", "2"}});
  EXPECT_EQ(message(hub, Channel::kGraph, 1),
            json::parse(R"({"channel":"graph","from":1,"version":3,"set":{"n1":2},"gone":[]})"));
}

TEST(ChannelHub, ATableAnewHasNothingElse) {
  ChannelHub hub;
  hub.edit(Channel::kTiles, {{"1", "1"}, {"2", "1"}});
  hub.edit(Channel::kTiles, {{"2", "1"}, {"3", "4"}}, true);
  EXPECT_EQ(message(hub, Channel::kTiles, 1),
            json::parse(R"({"channel":"tiles","from":1,"version":2,"set":{"3":4},"gone":["1"]})"));
}

TEST(ChannelHub, WhoHoldsWhatTheHubDoesNotKnowGetsAllOfIt) {
  ChannelHub hub;
  hub.edit(Channel::kGraph, {{"n1", "1"}});
  EXPECT_EQ(message(hub, Channel::kGraph, 17)["from"], 0);
  for (std::size_t i = 0; i <= ChannelHub::kRemembered; ++i) {
    hub.edit(Channel::kGraph, {{"n2", "1"}});
    hub.edit(Channel::kGraph, {{"n2", ""}});
  }
  EXPECT_EQ(message(hub, Channel::kGraph, 1)["from"], 0) << "what was gone is forgotten";
}

TEST(ChannelHub, KeysAreTextsOfAnyKind) {
  ChannelHub hub;
  hub.edit(Channel::kPlaces, {{"room \"A\"\n\xff", "1"}});
  EXPECT_EQ(message(hub, Channel::kPlaces, 0)["set"].size(), 1U);
}

/// A viewer that reads now and then, at any times, has the same content as the table.
TEST(ChannelHub, ViewersWhoLookNowAndThenAreExact) {
  ChannelHub hub;
  std::map<std::string, std::string> truth;
  struct Viewer {
    std::uint64_t version = 0;
    std::map<std::string, std::string> table;
  };
  std::vector<Viewer> viewers(5);
  std::mt19937 random(7);
  for (int step = 0; step < 3000; ++step) {
    std::vector<Edit> edits;
    std::map<std::string, std::string> named;
    for (unsigned i = 0; i < 1 + random() % 3; ++i) {
      const std::string key = "n" + std::to_string(random() % 40);
      named[key] = random() % 3 == 0 ? "" : std::to_string(random() % 5);
    }
    const bool anew = random() % 50 == 0;
    if (anew) truth.clear();
    for (const auto& [key, value] : named) {
      if (anew && value.empty()) continue;
      edits.push_back({key, value});
      if (value.empty()) {
        truth.erase(key);
      } else {
        truth[key] = value;
      }
    }
    hub.edit(Channel::kGraph, edits, anew);
    for (Viewer& viewer : viewers) {
      if (random() % 20 != 0 || hub.version(Channel::kGraph) == viewer.version) continue;
      const json update = message(hub, Channel::kGraph, viewer.version);
      if (update["from"] == 0) {
        viewer.table.clear();
      } else {
        ASSERT_EQ(update["from"], viewer.version);
      }
      for (const auto& [key, value] : update["set"].items()) viewer.table[key] = value.dump();
      for (const auto& key : update["gone"]) {
        ASSERT_EQ(viewer.table.erase(key.get<std::string>()) <= 1, true);
      }
      viewer.version = update["version"];
      ASSERT_EQ(viewer.table, truth) << "step " << step;
    }
  }
}

TEST(ChannelHub, ChannelsHaveNames) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto channel = static_cast<Channel>(i);
    EXPECT_EQ(channel_of(name_of(channel)), channel);
  }
  EXPECT_EQ(channel_of("nothing"), std::nullopt);
}

}  // namespace
}  // namespace topogeo::web
