// The drawing on the map: shows it, and passes edited drawings to the map store or the simulator.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/drawing.h"
#include "topogeo/service/service.hpp"

#include "orders/drawing_text.hpp"
#include "orders/pending_requests.hpp"
#include "server/channel_hub.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service, except shown() and takes_floors().
class DrawingEditor {
 public:
  DrawingEditor(service::Service& service, ChannelHub& hub, EventLog& events);

  /// Answer to GET /api/drawing. Thread-safe.
  [[nodiscard]] Answer shown() const;
  /// Whether a simulator can put the robot into another floor. Thread-safe.
  [[nodiscard]] bool takes_floors() const { return floors_.matched() > 0; }

  // POST handlers; they throw std::invalid_argument like the parsers of drawing_text.hpp.
  void replace(const std::string& body, const Respond& respond);
  void load_floor(const std::string& body, const Respond& respond);
  /// Drops all pending answers, because each holds a connection. Call it before the server ends.
  void abandon() { pending_.reset(); }

 private:
  void on_state(const msg::DrawingState& state);
  void on_answer(const msg::DrawingAnswer& answer);
  template <class Order>
  void send(Order order, messaging::Writer<Order>& writer, const std::string& robot_id,
            const Respond& respond);
  void load_into_map(const FloorText& floor, const Respond& respond);
  void load_into_simulator(const FloorText& floor, const Respond& respond);
  [[nodiscard]] const std::string& map_robot() const;

  service::Service& service_;
  ChannelHub& hub_;
  EventLog& events_;
  std::string client_id_;
  std::optional<PendingRequests> pending_;
  std::uint64_t sent_ = 0;
  std::uint64_t version_ = 0;  // of the shown drawing
  mutable std::mutex mutex_;
  std::shared_ptr<const std::string> json_;  // null: none received
  messaging::Writer<msg::DrawingOrder> orders_;
  messaging::Writer<msg::FloorOrder> floors_;
};

}  // namespace topogeo::web
