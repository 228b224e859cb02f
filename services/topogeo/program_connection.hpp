// Connects a command with the program of one robot among those of several.
#pragma once

#include <algorithm>
#include <chrono>
#include <set>

#include "topogeo/messaging/events.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"

namespace topogeo::cli {

/// Waits until `commands` is connected with a program whose status `wanted` accepts, at most
/// `patience`: a command that is sent when only another robot is connected is lost.
template <class Status, class Command, class Wanted>
bool connect_with_program(messaging::Reader<Status>& statuses,
                          const messaging::Writer<Command>& commands,
                          std::chrono::milliseconds patience, const Wanted& wanted) {
  constexpr std::chrono::milliseconds kConnectionPoll{20};
  std::set<messaging::Handle> programs;
  const auto end = std::chrono::steady_clock::now() + patience;
  const auto connected = [&](const messaging::Handle& program) {
    return commands.connected_with(program);
  };
  while (true) {
    statuses.take([&](const Status& status, const messaging::SampleInfo& info) {
      if (info.valid && wanted(status)) programs.insert(info.writer);
    });
    if (std::ranges::any_of(programs, connected)) return true;
    if (std::chrono::steady_clock::now() >= end) return false;
    static_cast<void>(statuses.wait_for_data(kConnectionPoll));
  }
}

}  // namespace topogeo::cli
