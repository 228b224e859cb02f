// The profiles file and the topics fit together.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "fixture.hpp"
#include "profile_names.hpp"

namespace topogeo::messaging {
namespace {

TEST(Topics, HaveNamesOfTheirOwnThatCarryTheSchemaVersion) {
  const std::string prefix = "topogeo/v" + std::to_string(msg::kSchemaVersion) + "/";
  std::set<std::string_view> names;
  for (const TopicInfo* topic : all_topics()) {
    EXPECT_TRUE(names.insert(topic->name).second) << topic->name;
    EXPECT_TRUE(topic->name.starts_with(prefix)) << topic->name;
  }
  EXPECT_FALSE(names.empty());
}

TEST(Profiles, WriterAndReaderOfEveryTopicMatch) {
  const std::string partition = random_partition();
  const Participant sender(options_in(partition));
  const Participant receiver(options_in(partition));
  for (const TopicInfo* topic : all_topics()) {
    for (const std::string_view role : {topic->role, topic->replay_role}) {
      if (role.empty()) continue;
      const detail::WriterCore writer(sender, *topic, std::string(role));
      const detail::ReaderCore reader(receiver, *topic, std::string(role), {});
      EXPECT_TRUE(wait_for_peers(writer)) << topic->name << " " << role;
      EXPECT_TRUE(wait_for_peers(reader)) << topic->name << " " << role;
    }
  }
}

TEST(Profiles, BuiltInTextIsTheFileOfDeploy) {
  std::ifstream file(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "deploy/dds_profiles.xml");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_FALSE(text.empty());
  EXPECT_EQ(built_in_profiles(), text);
}

TEST(Profiles, ParticipantsOfAllTransportsHearEachOther) {
  for (const char* profile : {"local", "udp_only", "wan"}) {
    for (const bool default_sends : {false, true}) {
      const std::string partition = random_partition();
      ParticipantOptions named = options_in(partition);
      named.profile = profile;
      const Participant sender(default_sends ? options_in(partition) : named);
      const Participant receiver(default_sends ? named : options_in(partition));
      Writer<msg::Goal> writer(sender);
      Reader<msg::Goal> reader(receiver);
      ASSERT_TRUE(writer.write(message<msg::Goal>()));
      EXPECT_TRUE(wait_for_data(reader)) << profile << " " << default_sends;
    }
  }
}

TEST(Profiles, HaveTheNamesOfTheVersionOfFastDds) {
  const std::string old = "<heartbeatPeriod><sec>1</sec></heartbeatPeriod>";
  const std::string now = "<heartbeat_period><sec>1</sec></heartbeat_period>";
#if TOPOGEO_FAST_DDS == 2
  EXPECT_EQ(with_names_of_library(old), old);
#else
  EXPECT_EQ(with_names_of_library(old), now);
#endif
  EXPECT_EQ(with_names_of_library(now), now);
}

// Programs of several users, or short-lived ones, block the shared memory of Fast DDS 2.9.1.
TEST(Profiles, ByDefaultNothingIsPutIntoSharedMemory) {
  // Checks this process only, because other programs create segments at any time.
  const auto has_segments = [] {
    std::ifstream mapped("/proc/self/maps");
    for (std::string line; std::getline(mapped, line);) {
      if (line.find("/fastrtps_") != std::string::npos ||
          line.find("/fastdds_") != std::string::npos) {
        return true;
      }
    }
    return false;
  };
  const auto has_segments_with = [&](const ParticipantOptions& options) {
    const Participant participant(options);
    return has_segments();
  };
  ASSERT_FALSE(has_segments());
  ParticipantOptions options = options_in(random_partition());
  EXPECT_FALSE(has_segments_with(options));
  options.profile = "local";
  EXPECT_TRUE(has_segments_with(options));
}

TEST(Profiles, MistakesAreErrors) {
  ParticipantOptions unknown;
  unknown.profile = "carrier_pigeon";
  EXPECT_THROW(Participant{unknown}, std::runtime_error);
  ParticipantOptions far_domain;
  far_domain.domain = 233;
  EXPECT_THROW(Participant{far_domain}, std::invalid_argument);
  ParticipantOptions no_file;
  no_file.profiles_file = "/nonexistent/profiles.xml";
  EXPECT_THROW(Participant{no_file}, std::runtime_error);
  const Participant participant(options_in(random_partition()));
  EXPECT_THROW(Writer<msg::Goal>(participant, "no_such_role"), std::runtime_error);
  EXPECT_THROW(Reader<msg::Goal>(participant, {.role = "no_such_role"}), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::messaging
