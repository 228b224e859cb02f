// Takes and answers orders that change the drawing of a map, and publishes the drawing.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/drawing.h"
#include "topogeo/service/service.hpp"
#include "topogeo/storage/map_drawing.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class DrawingChannel {
 public:
  /// Makes a drawing part of the map, and stores it with the map. Throws
  /// std::runtime_error with the reason when it cannot.
  using Take = std::function<void(storage::MapDrawing)>;

  /// `drawing` is that of the map; each order reads it. `is_stored`: false for a map that
  /// is only shown. `resolution_m` is for floors turned into grids.
  DrawingChannel(service::Service& service, const storage::MapDrawing& drawing, bool is_stored,
                 double resolution_m, Take take);

  /// Publishes the current drawing; one that does not fit the messages is a fault.
  void publish(std::int64_t stamp_ns);

 private:
  void on_order(const msg::DrawingOrder& order);
  void answer(const msg::DrawingOrder& order, msg::DrawingResult result,
              const std::string& message);
  /// Returns true, and repeats the answer, when this order has already been answered.
  bool repeated(const msg::DrawingOrder& order);

  service::Service& service_;
  const storage::MapDrawing& drawing_;
  bool is_stored_;
  double resolution_m_;
  Take take_;
  std::int64_t stamp_ns_ = 0;  // of the last publication
  std::uint64_t states_sent_ = 0;
  std::uint64_t answers_sent_ = 0;
  std::deque<msg::DrawingAnswer> newest_;
  messaging::Writer<msg::DrawingState> states_;
  messaging::Writer<msg::DrawingAnswer> answers_;
};

}  // namespace topogeo::map_store
