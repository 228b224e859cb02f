// Floors that are drawn on the page, for the simulator of a run.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/drawing.h"

#include "run_options.hpp"

namespace topogeo::cli {

/// The same run with the simulated robot in a drawn floor, where a new map begins that has the
/// floor as its drawing. Writes NAME.world.yaml and NAME.zones.yaml into the folder of the run.
/// Throws std::invalid_argument saying what is wrong with the floor.
RunOptions with_floor(RunOptions options, const msg::FloorOrder& order, const std::string& name);

/// Takes orders to simulate a drawn floor and answers them. Lives in the loop of its run.
class FloorLoader {
 public:
  /// Called with the run to go on with, after the answer.
  using Load = std::function<void(const RunOptions&)>;

  FloorLoader(const messaging::Participant& participant, messaging::EventLoop& loop,
              RunOptions options, Load load);

 private:
  void on_order(const msg::FloorOrder& order);
  void answer(const msg::FloorOrder& order, msg::DrawingResult result, const std::string& message);

  messaging::EventLoop& loop_;
  RunOptions options_;
  Load load_;
  std::uint32_t floors_ = 0;
  std::uint64_t answers_sent_ = 0;
  msg::DrawingAnswer last_;  // for an order that comes again
  messaging::Reader<msg::FloorOrder> orders_;
  messaging::Writer<msg::DrawingAnswer> answers_;
};

}  // namespace topogeo::cli
