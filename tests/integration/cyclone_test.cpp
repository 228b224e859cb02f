// The wire contract with another implementation of DDS: Cyclone DDS, with types generated from our
// IDL by its own compiler, reads every topic and notices when an instance is disposed, which needs
// keys of at most 16 bytes.
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "program.hpp"

namespace topogeo::test {
namespace {

/// A message in which every key member is non-zero.
template <class T>
T keyed_message() {
  T message;
  messaging::set_header(message, "robot", 1, 2);
  if constexpr (requires { message.worker_id(); }) messaging::set_worker_id(message, "worker");
  if constexpr (requires { message.client_id(); }) messaging::set_client_id(message, "client");
  if constexpr (requires { message.instance_key(); }) {
    messaging::set_service(message, "service", "instance");
  }
  if constexpr (requires { message.local_map(); }) {
    messaging::set_header(message.local_map(), "robot", 1, 2);
  }
  if constexpr (requires { message.session(); }) message.session(0xfedcba9876543210ULL);
  if constexpr (requires { message.segment(); }) message.segment(0x01020304U);
  if constexpr (requires { message.tile(); }) message.tile(0x01020304U);
  return message;
}

class CycloneTest : public testing::Test {
 protected:
  CycloneTest() {
    use_udp_only();
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
    options.partition = kPartition;
    participant_.emplace(options);
    reader_ = std::make_unique<Program>(scratch_, "../tests/cyclone_reader",
                                        std::vector<std::string>{own_domain(), kPartition});
  }

  /// Whether the reader prints `line` while `send` is repeated, because messages may be lost.
  template <class Send>
  bool says(const std::string& line, const Send& send) {
    const auto said = [&] {
      return ('\n' + reader_->out()).find('\n' + line + '\n') != std::string::npos;
    };
    return wait_for("the other implementation to print '" + line + "'", said, [&] {
      send();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));  // pacing: it keeps the last ones
    });
  }

  /// Creates the writer at once; the returned function sends and compares.
  template <class T>
  std::function<void()> check() {
    return [this, name = std::string(messaging::TopicTraits<T>::info().name),
            writer = std::make_shared<messaging::Writer<T>>(*participant_)] {
      const T message = keyed_message<T>();
      const auto write = [&] { static_cast<void>(writer->write(message)); };
      ASSERT_TRUE(says("sample " + name, write)) << name << reader_->err();
      ASSERT_TRUE(says("disposed " + name, [&] {
        write();
        writer->dispose(message);
      })) << name;
    };
  }

  static constexpr const char* kPartition = "cyclone-test";
  Scratch scratch_;
  std::optional<messaging::Participant> participant_;
  std::unique_ptr<Program> reader_;
};

TEST_F(CycloneTest, ReadsEveryTopicAndHearsOfDisposals) {
  ASSERT_TRUE(says("ready", [] {})) << reader_->err();
  // Creates all writers first: the two implementations take seconds to discover each other.
  std::vector<std::function<void()>> checks;
#define TOPOGEO_TOPIC(type, name, role, replay_role, addressee) \
  checks.push_back(check<msg::type>());
#include "topogeo/messaging/topics.def"
  for (const std::function<void()>& each : checks) ASSERT_NO_FATAL_FAILURE(each());
}

}  // namespace
}  // namespace topogeo::test
