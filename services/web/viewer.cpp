#include "viewer.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include <boost/beast/core/buffers_to_string.hpp>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/host.hpp"

#include "access.hpp"
#include "json_values.hpp"

namespace topogeo::web {

namespace websocket = beast::websocket;

namespace {

constexpr std::chrono::milliseconds kHelloPatience{250};
constexpr std::chrono::seconds kSilence{20};  // pings are sent after half of it
constexpr std::size_t kMostMessage_bytes = 4096;
constexpr std::size_t kMostControls = 64;
constexpr int kMostRefusals = 20;
constexpr int kProtocol = 1;

}  // namespace

Viewer::Viewer(Connection connection, ServerState& state, std::shared_ptr<void> place)
    : state_(state),
      place_(std::move(place)),
      number_(++state.last_viewer),
      socket_(std::move(connection)),
      hello_timer_(socket_.get_executor()) {
  state_.viewers.insert(this);
}

Viewer::~Viewer() {
  state_.viewers.erase(this);
  state_.backend.release(number_);
  state_.show_viewers();
}

void Viewer::start(beast::http::request<beast::http::string_body> request) {
  beast::error_code ignored;
  socket_.next_layer().socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  websocket::stream_base::timeout timeout{kSilence, kSilence, true};
  socket_.set_option(timeout);
  socket_.read_message_max(kMostMessage_bytes);
  socket_.text(true);
  const auto kept = std::make_shared<decltype(request)>(std::move(request));
  socket_.async_accept(*kept, [self = shared_from_this(), kept](beast::error_code error) {
    if (error) return;
    self->state_.show_viewers();
    self->wait_for_hello();
    self->read();
  });
}

void Viewer::wait_for_hello() {
  hello_timer_.expires_after(kHelloPatience);
  hello_timer_.async_wait([self = shared_from_this()](beast::error_code error) {
    if (!error && !self->ready_) self->hello(ViewerMessage{});
  });
}

void Viewer::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    self->on_read(error);
  });
}

void Viewer::on_read(beast::error_code error) {
  if (error) {
    if (error == websocket::error::message_too_big) state_.refuse("too large");
    hello_timer_.cancel();
    state_.backend.release(number_);
    closing_ = true;
    return;
  }
  const std::string text = beast::buffers_to_string(buffer_.data());
  buffer_.consume(buffer_.size());
  if (!messages_.take(ServerState::now_s())) {
    refuse("too often", "too many messages");
  } else if (!socket_.got_text()) {
    refuse("no message", "expected text, not binary");
  } else {
    on_text(text);
  }
  if (!closing_) read();
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
      drive(message);
      break;
    case Op::kRelease:
      state_.backend.release(number_);
      break;
  }
  pump();
}

void Viewer::hello(const ViewerMessage& message) {
  hello_timer_.cancel();
  const std::string& token = state_.config.token;
  operator_ = !token.empty() && equal_in_constant_time(message.token, token);
  Json welcome = {{"op", "welcome"},
                  {"protocol", kProtocol},
                  {"life", state_.config.life},
                  {"may_write", operator_},
                  {"robot_id", state_.config.robot_id}};
  if (!operator_ && !message.token.empty()) {
    state_.refuse("no token");
    welcome["error"] = "wrong token";
  }
  control(welcome.dump());
  if (message.life == state_.config.life) {
    for (const auto& [channel, version] : message.have) {
      if (version <= state_.board.version(channel)) {
        held_.at(static_cast<std::size_t>(channel)) = version;
      }
    }
  }
  want(message);
  ready_ = true;
  state_.show_viewers();
  pump();
}

void Viewer::want(const ViewerMessage& message) {
  wanted_.fill(message.all_channels);
  for (const Channel channel : message.channels) {
    wanted_.at(static_cast<std::size_t>(channel)) = true;
  }
}

void Viewer::drive(const ViewerMessage& message) {
  if (operator_) {
    state_.backend.drive(number_, message.linear_mps, message.angular_radps);
  } else {
    refuse("no token", "this needs the operator's token", "drive");
  }
}

void Viewer::refuse(std::string_view reason, const std::string& sentence, std::string_view what) {
  state_.refuse(reason);
  Json out = {{"op", "refused"}, {"error", sentence}};
  if (!what.empty()) out["what"] = what;
  control(out.dump(-1, ' ', false, Json::error_handler_t::replace));
  if (++refusals_ > kMostRefusals) close();
  pump();
}

void Viewer::close() {
  if (closing_) return;
  closing_ = true;
  state_.backend.release(number_);
  socket_.async_close(websocket::close_code::policy_error,
                      [self = shared_from_this()](beast::error_code) {});
}

void Viewer::control(std::string text) {
  if (controls_.size() >= kMostControls) controls_.pop_front();
  controls_.push_back(std::move(text));
}

std::size_t Viewer::next_channel() const {
  std::size_t next = kChannels;
  for (std::size_t i = 0; i < kChannels; ++i) {
    if (!wanted_.at(i)) continue;
    if (!anew_.at(i) && state_.board.version(static_cast<Channel>(i)) == held_.at(i)) continue;
    if (next == kChannels || sent_.at(i) < sent_.at(next)) next = i;
  }
  return next;
}

void Viewer::pump() {
  if (writing_ || closing_ || !ready_) return;
  if (!controls_.empty()) {
    auto text = std::make_shared<const std::string>(std::move(controls_.front()));
    controls_.pop_front();
    write(std::move(text));
    return;
  }
  const std::size_t next = next_channel();
  if (next == kChannels) return;
  const Update update =
      state_.board.update(static_cast<Channel>(next), anew_.at(next) ? 0 : held_.at(next));
  anew_.at(next) = false;
  held_.at(next) = update.version;
  sent_.at(next) = ++messages_sent_;
  write(update.text);
}

void Viewer::write(std::shared_ptr<const std::string> text) {
  writing_ = true;
  state_.tally.add("messages_sent");
  state_.tally.add("bytes_sent", text->size());
  const auto buffer = asio::buffer(*text);
  socket_.async_write(buffer, [self = shared_from_this(), text = std::move(text)](
                                  beast::error_code error, std::size_t) {
    self->writing_ = false;
    if (error) {
      self->closing_ = true;
    } else {
      self->pump();
    }
  });
}

}  // namespace topogeo::web
