#include "orders/drawing_editor.hpp"

#include <optional>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/support/host.hpp"

#include "channels/event_log.hpp"

namespace topogeo::web {
namespace {

constexpr double kDrawingPatience_s = 5.0;

}  // namespace

DrawingEditor::DrawingEditor(service::Service& service, ChannelHub& hub, EventLog& events)
    : service_(service),
      hub_(hub),
      events_(events),
      client_id_(support::process_name()),
      pending_(std::in_place, service, "no answer: the map store or the simulator does not run",
               kDrawingPatience_s),
      orders_(service.advertise<msg::DrawingOrder>()),
      floors_(service.advertise<msg::FloorOrder>()) {
  service.subscribe<msg::DrawingState>([this](const msg::DrawingState& state) { on_state(state); },
                                       {.of_map = true});
  service.subscribe<msg::DrawingAnswer>(
      [this](const msg::DrawingAnswer& answer) { on_answer(answer); }, {.any_robot = true});
}

const std::string& DrawingEditor::map_robot() const {
  const std::string& other = service_.setup().options.map_robot;
  return other.empty() ? service_.robot_id() : other;
}

Answer DrawingEditor::shown() const {
  const std::scoped_lock lock(mutex_);
  if (!json_) return error_answer(503, "no map store has published a drawing yet");
  return {200, *json_};
}

void DrawingEditor::on_state(const msg::DrawingState& state) {
  storage::MapDrawing drawing = service::from_msg(state.content());
  drawing.version = version_ = state.version();
  auto json = std::make_shared<const std::string>(text_of(json_of(drawing)));
  {
    const std::scoped_lock lock(mutex_);
    json_ = std::move(json);
  }
  hub_.set(Channel::kDrawing, text_of(Json{{"version", std::to_string(state.version())}}));
}

template <class Order>
void DrawingEditor::send(Order order, messaging::Writer<Order>& writer, const std::string& robot_id,
                         const Respond& respond) {
  messaging::set_header(order, robot_id, support::wall_clock_ns(), sent_++);
  messaging::set_client_id(order, client_id_);
  pending_->begin(
      respond,
      [&writer, order](std::uint64_t id) mutable {
        order.request_id(id);
        static_cast<void>(writer.write(order));
      },
      [&writer] { return writer.matched() > 0; });
}

void DrawingEditor::replace(const std::string& body, const Respond& respond) {
  const storage::MapDrawing drawing = parse_drawing(body);
  msg::DrawingOrder order;
  order.kind(msg::kDrawingReplace);
  order.version(drawing.version);
  order.content(service::to_msg(drawing));
  send(std::move(order), orders_, map_robot(), respond);
}

void DrawingEditor::load_floor(const std::string& body, const Respond& respond) {
  const FloorText floor = parse_floor(body);
  if (floor.simulator) {
    load_into_simulator(floor, respond);
  } else {
    load_into_map(floor, respond);
  }
}

void DrawingEditor::load_into_map(const FloorText& floor, const Respond& respond) {
  msg::DrawingOrder order;
  order.kind(msg::kDrawingFloor);
  order.version(version_);
  order.inside().x_m(floor.T_floor_start.x_m);
  order.inside().y_m(floor.T_floor_start.y_m);
  order.content(service::to_msg(floor.drawing));
  send(std::move(order), orders_, map_robot(), [respond](Answer answer) {
    respond(answer.status == 200 ? Answer{202, "{}"} : std::move(answer));
  });
}

void DrawingEditor::load_into_simulator(const FloorText& floor, const Respond& respond) {
  if (!takes_floors()) {
    respond(
        error_answer(409, "the robot is not simulated, or its simulator does not accept floors"));
    return;
  }
  msg::FloorOrder order;
  messaging::set_text(order.name(), floor.name, "name");
  order.T_floor_start(service::to_msg(floor.T_floor_start));
  order.content(service::to_msg(floor.drawing));
  send(std::move(order), floors_, service_.robot_id(), [respond](Answer answer) {
    respond(answer.status == 200 ? Answer{202, "{}"} : std::move(answer));
  });
}

void DrawingEditor::on_answer(const msg::DrawingAnswer& answer) {
  if (!pending_ || answer.client_id() != client_id_.c_str()) return;
  const std::optional<Respond> respond = pending_->take(answer.request_id());
  if (!respond) return;
  const std::string message = text_of_message(answer.message());
  Json json = {{"version", std::to_string(answer.version())}};
  if (answer.result() == msg::kDrawingDone) {
    if (!message.empty()) json["message"] = message;
    events_.add(EventLog::Level::kInfo, "drawing",
                message.empty() ? "the drawing was changed" : message);
    (*respond)({200, text_of(json)});
    return;
  }
  json["error"] = message.empty() ? "the drawing was refused" : message;
  (*respond)({answer.result() == msg::kDrawingInvalid ? 400U : 409U, text_of(json)});
}

}  // namespace topogeo::web
