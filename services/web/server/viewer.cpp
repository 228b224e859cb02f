#include "server/viewer.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/host.hpp"

#include "server/access.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {

namespace {

constexpr std::chrono::milliseconds kHelloPatience{250};
constexpr int kProtocol = 1;
/// Time that a base drives on without an order: an older order was delayed somewhere.
constexpr double kLatestOrder_s = 0.3;

}  // namespace

Viewer::Viewer(Connection connection, ServerState& state, std::shared_ptr<void> place,
               bool has_token)
    : Watcher(std::move(connection), state, std::move(place), has_token),
      number_(++state.last_viewer),
      hello_timer_(socket().get_executor()) {}

Viewer::~Viewer() {
  state().backend.release(number_);
  state().backend.leave(number_);
}

void Viewer::on_open() {
  hello_timer_.expires_after(kHelloPatience);
  hello_timer_.async_wait([weak = weak_from_this(), this](beast::error_code error) {
    const auto self = weak.lock();
    if (self && !error && !ready_) hello(ViewerMessage{});
  });
}

void Viewer::on_end() {
  hello_timer_.cancel();
  state().backend.release(number_);
  state().backend.leave(number_);
}

void Viewer::on_text(const std::string& text) {
  try {
    on_message(parse_viewer_message(text));
  } catch (const std::invalid_argument& error) {
    refuse("no message", error.what());
  }
}

void Viewer::on_message(const ViewerMessage& message) {
  using Op = ViewerMessage::Op;
  constexpr double kMilli = 1e-3;
  const double late_s =
      message.page_ms ? transit_.lateness_s(kMilli * *message.page_ms, state().config.clock_s())
                      : 0.0;
  if (message.op != Op::kHello && !ready_) hello(ViewerMessage{});
  switch (message.op) {
    case Op::kHello:
      hello(message);
      break;
    case Op::kWant:
      want(message);
      break;
    case Op::kResync:
      anew_.at(static_cast<std::size_t>(message.channel)) = true;
      break;
    case Op::kPing:
      control(Json{{"op", "pong"}, {"time_s", static_cast<double>(support::wall_clock_ns()) / 1e9}}
                  .dump());
      break;
    case Op::kDrive:
      drive(message, late_s);
      break;
    case Op::kRelease:
      state().backend.release(number_);
      break;
    case Op::kStop:
      stop();
      break;
  }
  pump();
}

void Viewer::hello(const ViewerMessage& message) {
  hello_timer_.cancel();
  const std::string& token = state().config.token;
  if (!token.empty() && equal_in_constant_time(message.token, token)) set_operator();
  Json welcome = {{"op", "welcome"},
                  {"protocol", kProtocol},
                  {"life", state().config.life},
                  {"may_write", is_operator()},
                  {"robot_id", state().config.robot_id}};
  if (is_operator()) {
    page_ = message.page;
    welcome["page"] = state().backend.enter(number_, page_, message.name);
  }
  if (!is_operator() && !message.token.empty()) {
    state().refuse("no token");
    welcome["error"] = "wrong token";
  }
  control(welcome.dump());
  if (message.life == state().config.life) {
    for (const auto& [channel, version] : message.have) {
      if (version <= state().hub.version(channel)) {
        held_.at(static_cast<std::size_t>(channel)) = version;
      }
    }
  }
  want(message);
  ready_ = true;
  state().show_viewers();
  pump();
}

void Viewer::want(const ViewerMessage& message) {
  wanted_.fill(message.all_channels);
  for (const Channel channel : message.channels) {
    wanted_.at(static_cast<std::size_t>(channel)) = true;
  }
}

void Viewer::drive(const ViewerMessage& message, double late_s) {
  if (!is_operator()) {
    refuse("no token", "this needs the operator's token", "drive");
  } else if (late_s > kLatestOrder_s) {
    state().refuse("late");
    control(text_of(Json{{"op", "refused"},
                         {"what", "drive"},
                         {"late_s", rounded(late_s)},
                         {"error", "the drive order arrived too late"}}));
  } else {
    state().backend.drive(number_, message.linear_mps, message.angular_radps);
  }
}

void Viewer::stop() {
  if (!is_operator()) {
    refuse("no token", "this needs the operator's token", "stop");
    return;
  }
  // A viewer that has gone meanwhile gets no answer; its last reference must end in this thread.
  const auto self = std::static_pointer_cast<Viewer>(shared_from_this());
  state().backend.stop(page_, [weak = std::weak_ptr<Viewer>(self),
                               executor = socket().get_executor()](Answer answer) {
    asio::post(executor, [weak, answer = std::move(answer)] {
      if (const auto viewer = weak.lock()) viewer->show_stop(answer);
    });
  });
}

void Viewer::show_stop(const Answer& answer) {
  control(text_of(Json{{"op", "stopped"}, {"status", answer.status}}));
  pump();
}

std::string Viewer::refusal(const std::string& sentence, std::string_view what) const {
  Json out = {{"op", "refused"}, {"error", sentence}};
  if (!what.empty()) out["what"] = what;
  return text_of(out);
}

std::size_t Viewer::next_channel() const {
  std::size_t next = kChannels;
  for (std::size_t i = 0; i < kChannels; ++i) {
    if (!wanted_.at(i)) continue;
    if (!anew_.at(i) && state().hub.version(static_cast<Channel>(i)) == held_.at(i)) continue;
    if (next == kChannels || sent_.at(i) < sent_.at(next)) next = i;
  }
  return next;
}

Watcher::Work Viewer::next_work() {
  const std::size_t next = next_channel();
  if (!ready_ || next == kChannels) return {};
  made_ = next;
  sent_.at(next) = ++messages_sent_;
  const std::uint64_t held = std::exchange(anew_.at(next), false) ? 0 : held_.at(next);
  return [&hub = state().hub, channel = static_cast<Channel>(next), held] {
    const Update update = hub.update(channel, held);
    return Made{{{update.text, false}}, update.version};
  };
}

void Viewer::on_made(std::uint64_t version) {
  held_.at(made_) = version;
}

}  // namespace topogeo::web
