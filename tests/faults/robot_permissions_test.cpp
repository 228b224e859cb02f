// The key of one robot is stolen and its program is changed: it writes and reads data of another
// robot. Its peers refuse that, count it and name it by its certificate.
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <fastdds/rtps/common/Token.h>
#include <gmock/gmock.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/strangers.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "program.hpp"

namespace {

/// Whether programs of this process check their own permissions before they create a writer or
/// reader.
bool g_obedient = true;

/// The certificate subject that they announce; empty: the true one.
std::string g_announced_subject;  // NOLINT(cert-err58-cpp)

constexpr const char* kGetIdentity =
    "_ZN8eprosima8fastrtps4rtps8security5PKIDH18get_identity_tokenEPPNS1_10DataHolderERKNS2_"
    "6HandleERNS2_17SecurityExceptionE";
constexpr const char* kCheckWriter =
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datawriterERKNS2_6HandleEjRK"
    "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_"
    "17SecurityExceptionE";
constexpr const char* kCheckReader =
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datareaderERKNS2_6HandleEjRK"
    "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_"
    "17SecurityExceptionE";

/// The decision of the library, whose function this test replaces.
template <class... Arguments>
bool decide(const char* symbol, Arguments... arguments) {
  using Function = bool (*)(Arguments...);
  const auto original = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, symbol));  // NOLINT
  return !g_obedient || original(arguments...);
}

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" bool
check_own_writer(void* plugin, const void* own, std::uint32_t domain, const void* topic, const void* partitions, void* error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datawriterERKNS2_6HandleEjRK"
    "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_"
    "17SecurityExceptionE");
extern "C" bool
check_own_reader(void* plugin, const void* own, std::uint32_t domain, const void* topic, const void* partitions, void* error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datareaderERKNS2_6HandleEjRK"
    "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_"
    "17SecurityExceptionE");
extern "C" bool
get_identity(void* plugin, eprosima::fastrtps::rtps::IdentityToken** token, const void* own, void* error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security5PKIDH18get_identity_tokenEPPNS1_10DataHolderERKNS2_"
    "6HandleERNS2_17SecurityExceptionE");
// NOLINTEND

extern "C" bool get_identity(void* plugin, eprosima::fastrtps::rtps::IdentityToken** token,
                             const void* own, void* error) {
  static const auto original =
      reinterpret_cast<decltype(&get_identity)>(::dlsym(RTLD_NEXT, kGetIdentity));  // NOLINT
  if (!original(plugin, token, own, error)) return false;
  for (auto& property : (*token)->properties()) {
    if (property.name() == "dds.cert.sn" && !g_announced_subject.empty()) {
      property.value(g_announced_subject);
    }
  }
  return true;
}

extern "C" bool check_own_writer(void* plugin, const void* own, std::uint32_t domain,
                                 const void* topic, const void* partitions, void* error) {
  return decide(kCheckWriter, plugin, own, domain, topic, partitions, error);
}

extern "C" bool check_own_reader(void* plugin, const void* own, std::uint32_t domain,
                                 const void* topic, const void* partitions, void* error) {
  return decide(kCheckReader, plugin, own, domain, topic, partitions, error);
}

namespace topogeo::test {
namespace {

using messaging::Participant;
using messaging::Reader;
using messaging::SampleInfo;
using messaging::Writer;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kThief = "(/O=topogeo/OU=anna/CN=sensor_gateway.anna; ";

class RobotPermissionsTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* robots_and_host :
         {"--robot anna anna", "--robot bert bert", "--robot all pool"}) {
      if (!issue_keys(scratch_ / "keys",
                      std::string(robots_and_host) + " sensor_gateway local_mapper map_store")) {
        GTEST_SKIP() << "openssl is missing";
      }
    }
  }
  void TearDown() override {
    g_obedient = true;
    g_announced_subject.clear();
  }

  [[nodiscard]] std::filesystem::path keys_of(const std::string& host) const {
    return scratch_ / ("keys/" + host);
  }

  Participant join(const std::string& host, const std::string& service,
                   const std::string& robot = "") {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
    options.name = host + "/" + service;
    options.identity = service;
    options.security = keys_of(host);
    if (!robot.empty()) options.robots = {robot};
    return Participant(options);
  }

  /// A modified program with the keys of anna's gateway, which requests data of `robots` and
  /// announces the certificate of bert's gateway.
  Participant steal(const std::string& robots) {
    g_obedient = false;
    std::filesystem::copy(keys_of("anna"), keys_of("thief"),
                          std::filesystem::copy_options::recursive);
    for (const char* service : {"sensor_gateway", "local_mapper"}) {
      std::ofstream(keys_of("thief") / service / "robots") << robots << '\n';
    }
    g_announced_subject = "/O=topogeo/OU=bert/CN=sensor_gateway.bert";
    Participant thief = join("thief", "sensor_gateway");
    g_announced_subject.clear();
    return thief;
  }

  static msg::Scan scan(const std::string& robot, std::uint64_t number) {
    msg::Scan scan;
    messaging::set_header(scan, robot, 0, number);
    return scan;
  }

  /// Writes scans and takes received ones until the condition holds.
  template <class Condition>
  [[nodiscard]] bool wait(const std::string& what, const Condition& condition) {
    return wait_for(what, condition, [this] {
      for (const auto& step : steps_) step();
    });
  }

  void write_for(Writer<msg::Scan>& writer, const std::string& robot) {
    steps_.emplace_back([&writer, robot, number = std::uint64_t{0}]() mutable {
      static_cast<void>(writer.write(scan(robot, number++)));
    });
  }

  /// Collects the robots of all received scans.
  void read_to(std::vector<std::string>& robots, Reader<msg::Scan>& reader) {
    steps_.emplace_back([&] {
      reader.take([&](const msg::Scan& got, const SampleInfo& info) {
        if (info.valid) robots.push_back(got.robot_id().to_string());
      });
      static_cast<void>(reader.wait_for_data(std::chrono::milliseconds(5)));
    });
  }

  /// Whether the participant has refused something for this reason at any time.
  bool has_refused(const Participant& participant, const std::string& how) {
    for (std::string& line : participant.take_refusals()) refusals_.push_back(std::move(line));
    return std::ranges::any_of(refusals_, [&](const std::string& line) {
      return line.find(kThief) != std::string::npos && line.find(how) != std::string::npos;
    });
  }

  Scratch scratch_;
  const std::string domain_ = own_domain();
  std::vector<std::function<void()>> steps_;
  std::vector<std::string> refusals_;
};

TEST_F(RobotPermissionsTest, SamplesForAnotherRobotAreRefused) {
  const Participant store = join("pool", "map_store");
  const Participant gateway = join("anna", "sensor_gateway", "anna");
  Reader<msg::Scan> reader(store);
  Writer<msg::Scan> writer(gateway);
  std::vector<std::string> robots;
  write_for(writer, "anna");
  write_for(writer, "bert");
  read_to(robots, reader);
  const std::uint64_t before = messaging::stranger_counts().denied_samples;
  ASSERT_TRUE(wait("scans of both robots to be read or refused", [&] {
    return robots.size() >= 10 && messaging::stranger_counts().denied_samples >= before + 10;
  }));
  EXPECT_THAT(robots, testing::Each("anna"));
  EXPECT_TRUE(has_refused(store, "/scan for robot 'bert'"));
}

TEST_F(RobotPermissionsTest, AWriterInThePartitionOfAnotherRobotIsDenied) {
  const Participant mapper = join("bert", "local_mapper", "bert");
  const Participant gateway = join("bert", "sensor_gateway", "bert");
  const Participant thief = steal("bert");
  Reader<msg::Scan> reader(mapper);
  Writer<msg::Scan> writer(gateway);
  Writer<msg::Scan> forged(thief);
  std::vector<std::string> robots;
  std::uint64_t number = 0;
  steps_.emplace_back([&] { static_cast<void>(forged.write(scan("bert", 1'000'000 + number++))); });
  std::uint64_t highest = 0;
  write_for(writer, "bert");
  steps_.emplace_back([&] {
    reader.take([&](const msg::Scan& got, const SampleInfo& info) {
      if (!info.valid) return;
      robots.push_back(got.robot_id().to_string());
      highest = std::max(highest, got.sequence_number());
    });
    static_cast<void>(reader.wait_for_data(std::chrono::milliseconds(5)));
  });
  ASSERT_TRUE(wait("the thief to be denied and bert's own scans",
                   [&] { return has_refused(mapper, "may not write ") && robots.size() >= 10; }));
  EXPECT_LT(highest, 1'000'000U);
  EXPECT_EQ(reader.matched(), 1);
}

TEST_F(RobotPermissionsTest, AReaderInThePartitionOfAnotherRobotIsDenied) {
  const Participant gateway = join("bert", "sensor_gateway", "bert");
  const Participant mapper = join("bert", "local_mapper", "bert");
  const Participant thief = steal("all");
  Writer<msg::Scan> writer(gateway);
  Reader<msg::Scan> reader(mapper);
  Reader<msg::Scan> spy(thief);
  std::vector<std::string> robots;
  std::vector<std::string> stolen;
  write_for(writer, "bert");
  read_to(robots, reader);
  read_to(stolen, spy);
  ASSERT_TRUE(wait("the thief to be denied and bert's own scans",
                   [&] { return has_refused(gateway, "may not read ") && robots.size() >= 10; }));
  EXPECT_TRUE(stolen.empty());
  EXPECT_EQ(writer.matched(), 1);
}

TEST_F(RobotPermissionsTest, AProgramThatIsNotChangedEndsWithItsOwnDenial) {
  const Participant thief = steal("bert");
  g_obedient = true;
  EXPECT_THAT([&] { const Writer<msg::Scan> writer(thief); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("denied by security"), HasSubstr("topogeo/bert"))));
}

TEST_F(RobotPermissionsTest, KeysOfAnotherRobotAreAClearError) {
  EXPECT_THAT([&] { static_cast<void>(join("anna", "local_mapper", "bert")); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("keys/anna/local_mapper'"),
                        HasSubstr("the keys are for 'anna', not for 'bert'"))));
}

// Older keys have no list of robots, and permissions for every partition.
TEST_F(RobotPermissionsTest, OlderKeysWorkForEveryRobot) {
  for (const char* service : {"sensor_gateway", "local_mapper"}) {
    std::filesystem::remove(keys_of("pool") / service / "robots");
  }
  const Participant mapper = join("anna", "local_mapper", "anna");
  const Participant older = join("pool", "sensor_gateway", "anna");
  const Participant older_mapper = join("pool", "local_mapper", "bert");
  const Participant gateway = join("bert", "sensor_gateway", "bert");
  Reader<msg::Scan> reader(mapper);
  Writer<msg::Scan> older_writer(older);
  Reader<msg::Scan> older_reader(older_mapper);
  Writer<msg::Scan> writer(gateway);
  std::vector<std::string> robots;
  std::vector<std::string> older_robots;
  write_for(older_writer, "anna");
  write_for(writer, "bert");
  read_to(robots, reader);
  read_to(older_robots, older_reader);
  ASSERT_TRUE(wait("scans from and for older keys", [&] {
    return robots.size() >= 10 && std::ranges::count(older_robots, "bert") >= 10;
  }));
  EXPECT_THAT(robots, testing::Each("anna"));
}

}  // namespace
}  // namespace topogeo::test
