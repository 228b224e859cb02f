// Puts floors drawn on the page into the simulator of a run.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/drawing.h"

#include "run/run_options.hpp"

namespace topogeo::cli {

/// Options of the same run with the simulated robot in a drawn floor and with a new map that has
/// the floor as its drawing. Writes NAME.world.yaml and NAME.zones.yaml into the folder of the run.
/// Throws std::invalid_argument naming the fault of the floor.
RunOptions with_floor(RunOptions options, const msg::FloorOrder& order, const std::string& name);

/// Takes and answers orders to simulate a drawn floor. Must be used in the loop of its run only.
class FloorLoader {
 public:
  /// Called after the answer, with the options of the run that continues.
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
  msg::DrawingAnswer last_;  // sent again for a repeated order
  messaging::Reader<msg::FloorOrder> orders_;
  messaging::Writer<msg::DrawingAnswer> answers_;
};

}  // namespace topogeo::cli
