// What is drawn on the map: shows it, and hands what is drawn anew to the map store or the
// simulator.
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
#include "server/board.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service, but for shown() and takes_floors().
class DrawingDesk {
 public:
  DrawingDesk(service::Service& service, Board& board, EventLog& events);

  /// GET /api/drawing. For any thread.
  [[nodiscard]] Answer shown() const;
  /// Somebody simulates the robot, and can simulate it elsewhere. For any thread.
  [[nodiscard]] bool takes_floors() const { return floors_.matched() > 0; }

  // POST; throw std::invalid_argument like the parsers of drawing_text.hpp.
  void replace(const std::string& body, const Respond& respond);
  void load_floor(const std::string& body, const Respond& respond);
  /// Nobody gets an answer any more: each holds on to a connection. Before the server goes.
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
  Board& board_;
  EventLog& events_;
  std::string client_id_;
  std::optional<PendingRequests> pending_;
  std::uint64_t sent_ = 0;
  std::uint64_t version_ = 0;  // of the drawing shown
  mutable std::mutex mutex_;
  std::shared_ptr<const std::string> json_;  // null: none has come
  messaging::Writer<msg::DrawingOrder> orders_;
  messaging::Writer<msg::FloorOrder> floors_;
};

}  // namespace topogeo::web
