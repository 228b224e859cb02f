#include "drawing_channel.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/support/log.hpp"

#include "drawing_order.hpp"

namespace topogeo::map_store {

namespace {

/// Orders come from people who wait for the answer: a few at a time.
constexpr std::size_t kAnswersRemembered = 64;

}  // namespace

DrawingChannel::DrawingChannel(service::Service& service, const storage::MapDrawing& drawing,
                               bool is_stored, double resolution_m, Take take)
    : service_(service),
      drawing_(drawing),
      is_stored_(is_stored),
      resolution_m_(resolution_m),
      take_(std::move(take)),
      states_(service.advertise<msg::DrawingState>()),
      answers_(service.advertise<msg::DrawingAnswer>()) {
  service.subscribe<msg::DrawingOrder>([this](const msg::DrawingOrder& order) { on_order(order); });
}

void DrawingChannel::publish(std::int64_t stamp_ns) {
  stamp_ns_ = stamp_ns;
  msg::DrawingState state;
  messaging::set_header(state, service_.robot_id(), stamp_ns, states_sent_);
  state.version(drawing_.version);
  state.is_stored(is_stored_);
  state.has_grid(drawing_.grid.has_value());
  try {
    state.content(service::to_msg(drawing_));
  } catch (const std::invalid_argument& error) {
    service_.status().fault("drawing not published", error.what());
    return;
  }
  if (service_.send(states_, state, "drawing")) ++states_sent_;
}

void DrawingChannel::on_order(const msg::DrawingOrder& order) {
  if (repeated(order)) return;
  DrawingOutcome outcome = carry_out(order, drawing_, resolution_m_);
  if (outcome.drawing) {
    try {
      take_(std::move(*outcome.drawing));
      if (!is_stored_)
        outcome.message =
            "in effect until the services end: the map is read-only, so its file does not store "
            "the drawing";
    } catch (const std::exception& error) {
      outcome.result = msg::kDrawingNotDone;
      outcome.message = error.what();
    }
  }
  if (outcome.result == msg::kDrawingDone) {
    service_.status().add_to_counter("drawings");
    spdlog::info("drawing {}: {} places, {} zones, {} walls, openings and doors", drawing_.version,
                 drawing_.places.size(), drawing_.zones.size(), drawing_.lines.size());
    publish(stamp_ns_);
  } else {
    service_.status().add_to_counter("drawings_refused");
  }
  answer(order, outcome.result, outcome.message);
}

void DrawingChannel::answer(const msg::DrawingOrder& order, msg::DrawingResult result,
                            const std::string& message) {
  msg::DrawingAnswer answer;
  messaging::set_header(answer, service_.robot_id(), stamp_ns_, answers_sent_++);
  answer.request_id(order.request_id());
  answer.client_id(order.client_id());
  answer.result(result);
  answer.version(drawing_.version);
  messaging::set_text_cut(answer.message(), message);
  static_cast<void>(service_.send(answers_, answer, "answer to a drawing"));
  newest_.push_back(std::move(answer));
  if (newest_.size() > kAnswersRemembered) newest_.pop_front();
}

bool DrawingChannel::repeated(const msg::DrawingOrder& order) {
  const auto given = std::ranges::find_if(newest_, [&](const msg::DrawingAnswer& answer) {
    return answer.request_id() == order.request_id() && answer.client_id() == order.client_id();
  });
  if (given == newest_.end()) return false;
  given->sequence_number(answers_sent_++);
  static_cast<void>(service_.send(answers_, *given, "answer to a drawing"));
  return true;
}

}  // namespace topogeo::map_store
