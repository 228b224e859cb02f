// Two participants in a partition of their own, so that test programs do not see each other.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "time_factor.hpp"

namespace topogeo::messaging {

/// Long enough for a busy machine; nothing waits so long when it works.
constexpr std::chrono::seconds kPatience{60 * test::kTimeFactor};

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

/// Polls until `condition` holds; false when patience ends first.
inline bool eventually(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
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
