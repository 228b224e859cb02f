// Connects a command to the program of one robot among several.
#pragma once

#include <algorithm>
#include <chrono>
#include <set>
#include <stdexcept>

#include "topogeo/messaging/events.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/patience.hpp"

namespace topogeo::cli {

/// Waits until `commands` is connected to a program whose status `wanted` accepts, or until the
/// patience ends: a command sent while only another robot is connected is lost.
template <class Status, class Command, class Wanted>
bool connect_with_program(messaging::Reader<Status>& statuses,
                          const messaging::Writer<Command>& commands, support::Patience& patience,
                          const Wanted& wanted) {
  constexpr std::chrono::milliseconds kConnectionPoll{20};
  std::set<messaging::Handle> programs;
  const auto connected = [&](const messaging::Handle& program) {
    return commands.connected_with(program);
  };
  while (true) {
    statuses.take([&](const Status& status, const messaging::SampleInfo& info) {
      if (info.valid && wanted(status)) programs.insert(info.writer);
    });
    if (std::ranges::any_of(programs, connected)) return true;
    if (patience.is_over(support::monotonic_s())) return false;
    static_cast<void>(statuses.wait_for_data(kConnectionPoll));
  }
}

/// Waits until the readers have received everything; false when the patience ends first.
template <class Command>
bool is_delivered(messaging::Writer<Command>& writer, support::Patience& patience) {
  constexpr std::chrono::milliseconds kAcknowledgmentPoll{100};
  while (!writer.wait_for_acknowledgments(kAcknowledgmentPoll)) {
    if (patience.is_over(support::monotonic_s())) return false;
  }
  return true;
}

/// Sends a command and waits until its readers have it. Throws std::runtime_error when it cannot be
/// sent or the patience ends first.
template <class Command>
void send_with(messaging::Writer<Command>& writer, const Command& command,
               support::Patience& patience) {
  if (!writer.write(command)) throw std::runtime_error("the command could not be sent");
  if (!is_delivered(writer, patience)) {
    throw std::runtime_error("the command was not received" + patience.reason());
  }
}

}  // namespace topogeo::cli
