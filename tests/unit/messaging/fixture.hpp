// Two participants in a partition of their own, so that test programs do not see each other.
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "waiting.hpp"

namespace topogeo::messaging {

inline std::string random_partition() {
  std::random_device device;
  return "test-" + std::to_string(device()) + std::to_string(device());
}

inline ParticipantOptions options_in(const std::string& partition) {
  ParticipantOptions options;
  options.partition = partition;
  options.name = "test";
  return options;
}

template <class Endpoint>
[[nodiscard]] bool wait_for_peers(const Endpoint& endpoint, int count = 1) {
  return test::wait_by(std::to_string(count) + " peers of a reader or writer",
                       [&](auto at_most) { return endpoint.wait_for_matched(count, at_most); });
}
template <class T>
[[nodiscard]] bool wait_for_data(Reader<T>& reader) {
  return test::wait_by("a first sample",
                       [&](auto at_most) { return reader.wait_for_data(at_most); });
}
template <class T>
[[nodiscard]] bool wait_for_acknowledgments(Writer<T>& writer) {
  return test::wait_by("all readers to confirm what was sent",
                       [&](auto at_most) { return writer.wait_for_acknowledgments(at_most); });
}
/// Runs a loop until a handler stops it.
[[nodiscard]] inline bool run_to_stop(EventLoop& loop) {
  return test::wait_by("an event loop to be stopped",
                       [&](auto at_most) { return loop.run_for(at_most); });
}

template <class T>
T message(std::uint64_t sequence_number = 0) {
  T result;
  set_header(result, "robot", 1'000, sequence_number);
  return result;
}

class TwoParticipants : public ::testing::Test {
 protected:
  std::string partition_ = random_partition();
  Participant sender_{options_in(partition_)};
  Participant receiver_{options_in(partition_)};
};

}  // namespace topogeo::messaging
