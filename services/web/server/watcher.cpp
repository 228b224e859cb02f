#include "server/watcher.hpp"

#include <chrono>
#include <utility>

#include <boost/beast/core/buffers_to_string.hpp>

namespace topogeo::web {

namespace websocket = beast::websocket;

namespace {

constexpr std::chrono::seconds kSilence{20};  // pings are sent after half of it
constexpr std::size_t kMostMessage_bytes = 4096;
constexpr std::size_t kMostControls = 64;
constexpr int kMostRefusals = 20;

}  // namespace

Watcher::Watcher(Connection connection, ServerState& state, std::shared_ptr<void> place,
                 bool has_token)
    : state_(state),
      place_(std::move(place)),
      socket_(std::move(connection)),
      operator_(has_token) {
  state_.viewers.insert(this);
}

Watcher::~Watcher() {
  state_.viewers.erase(this);
  state_.show_viewers();
}

void Watcher::start(beast::http::request<beast::http::string_body> request,
                    const std::string& subprotocol) {
  beast::error_code ignored;
  socket_.next_layer().socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  websocket::stream_base::timeout timeout{kSilence, kSilence, true};
  socket_.set_option(timeout);
  if (!subprotocol.empty()) {
    socket_.set_option(
        websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
          response.set(beast::http::field::sec_websocket_protocol, subprotocol);
        }));
  }
  socket_.read_message_max(kMostMessage_bytes);
  const auto kept = std::make_shared<decltype(request)>(std::move(request));
  socket_.async_accept(*kept, [self = shared_from_this(), kept](beast::error_code error) {
    if (error) return;
    self->open_ = true;
    self->state_.show_viewers();
    self->on_open();
    self->read();
  });
}

void Watcher::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    self->on_read(error);
  });
}

void Watcher::on_read(beast::error_code error) {
  if (error) {
    if (error == websocket::error::message_too_big) state_.refuse("too large");
    closing_ = true;
    on_end();
    return;
  }
  const std::string text = beast::buffers_to_string(buffer_.data());
  buffer_.consume(buffer_.size());
  if (!messages_.take(state_.config.clock_s())) {
    refuse("too often", "too many messages");
  } else if (!socket_.got_text()) {
    refuse("no message", "expected text, not binary");
  } else {
    on_text(text);
  }
  if (!closing_) read();
}

void Watcher::refuse(std::string_view reason, const std::string& sentence, std::string_view what) {
  state_.refuse(reason);
  control(refusal(sentence, what));
  if (++refusals_ > kMostRefusals) close();
  pump();
}

void Watcher::close() {
  if (closing_) return;
  closing_ = true;
  on_end();
  socket_.async_close(websocket::close_code::policy_error,
                      [self = shared_from_this()](beast::error_code) {});
}

void Watcher::control(std::string text) {
  if (controls_.size() >= kMostControls) controls_.pop_front();
  controls_.push_back(std::move(text));
}

void Watcher::pump() {
  if (writing_ || closing_ || !open_) return;
  if (!controls_.empty()) {
    auto text = std::make_shared<const std::string>(std::move(controls_.front()));
    controls_.pop_front();
    write({std::move(text), false});
  } else if (!frames_.empty()) {
    Frame frame = std::move(frames_.front());
    frames_.pop_front();
    write(std::move(frame));
  } else if (!making_) {
    make();
  }
}

// The last reference to a watcher must not be released in the answer thread.
void Watcher::make() {
  Work work = next_work();
  if (!work) return;
  making_ = true;
  state_.answers.post(operator_ ? AnswerThread::Turn::kFirst : AnswerThread::Turn::kLater,
                      [self = shared_from_this(), executor = socket_.get_executor(),
                       work = std::move(work)]() mutable {
                        asio::post(executor, [self = std::move(self), made = work()]() mutable {
                          self->take(std::move(made));
                        });
                      });
}

void Watcher::take(Made made) {
  making_ = false;
  frames_ = std::move(made.frames);
  on_made(made.version);
  pump();
}

void Watcher::write(Frame frame) {
  writing_ = true;
  state_.tally.add("messages_sent");
  state_.tally.add("bytes_sent", frame.bytes->size());
  socket_.binary(frame.binary);
  const auto buffer = asio::buffer(*frame.bytes);
  socket_.async_write(buffer, [self = shared_from_this(), bytes = std::move(frame.bytes)](
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
