#include "orders/manual_drive_thread.hpp"

#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "topogeo/support/host.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

Answer stop_answer(bool heard, bool navigator_hears) {
  if (heard) return {202, "{}"};
  if (navigator_hears) {
    return {202, text_of(Json{{"message",
                               "no base confirms the stop; this service and the navigator hold the "
                               "robot until the release"}})};
  }
  return error_answer(503,
                      "no base and no navigator is connected: only driving by hand is stopped");
}

Answer stopped_again() {
  return error_answer(409, "stopped again in the meantime: nothing is released");
}

Answer kept_stop_released() {
  return {202, text_of(Json{{"message",
                             "no base reports the release; this service and the navigator hold "
                             "the robot no longer: it may move again"}})};
}

Answer answer_of(UnconfirmedRelease::Outcome outcome) {
  switch (outcome) {
    case UnconfirmedRelease::Outcome::kReleased:
      break;
    case UnconfirmedRelease::Outcome::kRefused:
      return stopped_again();
    case UnconfirmedRelease::Outcome::kUnconfirmed:
      return {202, text_of(Json{{"message", "the base has not confirmed the release"}})};
  }
  return {202, "{}"};
}

}  // namespace

ManualDriveThread::ManualDriveThread(service::Service& service, ChannelHub& hub, EventLog& events,
                                     Tally& tally, ManualDriveSender::Hooks hooks,
                                     const std::filesystem::path& memory)
    : service_(service),
      hand_(loop_, service, hub, events, tally, std::move(hooks), memory),
      thread_([this] { run(); }) {}

ManualDriveThread::~ManualDriveThread() {
  end();
}

void ManualDriveThread::end() {
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  loop_.stop();
  if (thread_.joinable()) thread_.join();
  orders_.clear();
  hand_.forget_release();
}

void ManualDriveThread::run() {
  try {
    loop_.run();
  } catch (...) {
    service_.loop().post([error = std::current_exception()] { std::rethrow_exception(error); });
  }
}

void ManualDriveThread::drive(std::uint64_t viewer, const geometry::Velocity& wanted) {
  loop_.post([this, viewer, wanted, came_ns = support::monotonic_ns()] {
    hand_.drive(viewer, wanted, came_ns);
  });
}

void ManualDriveThread::release(std::uint64_t viewer) {
  loop_.post([this, viewer] { hand_.release(viewer); });
}

void ManualDriveThread::keep_off(std::shared_ptr<const navigation::DrawnLimits> limits) {
  loop_.post([this, limits = std::move(limits)]() mutable { hand_.keep_off(std::move(limits)); });
}

void ManualDriveThread::stop(Respond respond) {
  ++stops_;
  take({std::nullopt, std::move(respond)});
}

void ManualDriveThread::release_stop(std::uint64_t stops, Respond respond) {
  take({stops, std::move(respond)});
}

void ManualDriveThread::take(Order order) {
  {
    const std::scoped_lock lock(mutex_);
    if (ended_) return;
    orders_.push_back(std::move(order));
  }
  loop_.post([this] { work_off_orders(); });
}

void ManualDriveThread::work_off_orders() {
  std::deque<Order> orders;
  {
    const std::scoped_lock lock(mutex_);
    orders.swap(orders_);
  }
  for (const Order& order : orders) carry_out(order);
}

void ManualDriveThread::carry_out(const Order& order) {
  const Respond& respond = order.respond;
  if (!order.release) {
    const bool heard = hand_.stop();
    return respond(stop_answer(heard, hand_.navigator_hears()));
  }
  if (*order.release != stops_) return respond(stopped_again());
  const ManualDriveSender::Release sent = hand_.release_stop(
      [respond](UnconfirmedRelease::Outcome outcome) { respond(answer_of(outcome)); });
  switch (sent) {
    case ManualDriveSender::Release::kSent:
      return;
    case ManualDriveSender::Release::kHeldHere:
      return respond(kept_stop_released());
    case ManualDriveSender::Release::kUnheard:
      return respond(error_answer(
          503, "no base confirms the release; this service holds the robot no longer"));
  }
}

}  // namespace topogeo::web
