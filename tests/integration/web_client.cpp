#include "web_client.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "waiting.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kChunk_bytes = 65536;

int connect_to(std::uint32_t port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (fd < 0 || ::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) {
    const std::string why = std::strerror(errno);
    if (fd >= 0) ::close(fd);
    throw std::runtime_error("cannot connect to port " + std::to_string(port) + ": " + why);
  }
  return fd;
}

/// Closes its file descriptor.
class Socket {
 public:
  explicit Socket(std::uint32_t port) : fd_(connect_to(port)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() { ::close(fd_); }
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

void send_all(int fd, const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t now = ::send(fd, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now <= 0) return;  // the other side has closed: its answer can still be read
    sent += static_cast<std::size_t>(now);
  }
}

/// False at the end of the connection, and on a timeout.
bool receive_some(int fd, std::string& buffer, Clock::time_point end, bool* ended = nullptr) {
  const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
  pollfd wanted{fd, POLLIN, 0};
  if (left.count() <= 0 || ::poll(&wanted, 1, static_cast<int>(left.count())) <= 0) return false;
  std::string bytes(kChunk_bytes, '\0');
  const ssize_t got = ::recv(fd, bytes.data(), bytes.size(), 0);
  if (got <= 0) {
    if (ended != nullptr) *ended = true;
    return false;
  }
  buffer.append(bytes, 0, static_cast<std::size_t>(got));
  return true;
}

std::string request_text(std::uint32_t port, const std::string& method, const std::string& target,
                         const Headers& headers, const std::string& body) {
  std::string text = method + " " + target + " HTTP/1.1\r\n";
  const auto has = [&](const std::string& name) {
    return std::ranges::any_of(headers, [&](const auto& header) { return header.first == name; });
  };
  if (!has("Host")) text += "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  for (const auto& [name, value] : headers)
    text.append(name).append(": ").append(value).append("\r\n");
  if (!has("Connection")) text += "Connection: close\r\n";
  if (method == "POST") text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return text + "\r\n" + body;
}

HttpReply parse_reply(const std::string& text) {
  HttpReply reply;
  const std::size_t end = text.find("\r\n\r\n");
  if (end == std::string::npos || text.size() < 12) return reply;
  reply.head = text.substr(0, end + 2);
  reply.status = std::stoi(text.substr(9, 3));
  reply.body = text.substr(end + 4);
  return reply;
}

constexpr unsigned kContinuation = 0;
constexpr unsigned kText = 1;
constexpr unsigned kBinary = 2;
constexpr unsigned kClose = 8;
constexpr unsigned kPing = 9;
constexpr unsigned kPong = 10;

}  // namespace

HttpReply http_request(std::uint32_t port, const std::string& method, const std::string& target,
                       const Headers& headers, const std::string& body) {
  const Socket socket(port);
  send_all(socket.fd(), request_text(port, method, target, headers, body));
  std::string text;
  const Clock::time_point end = Clock::now() + hang_limit();
  while (receive_some(socket.fd(), text, end)) {
  }
  return parse_reply(text);
}

HttpReply http_get(std::uint32_t port, const std::string& target) {
  return http_request(port, "GET", target);
}

HttpReply http_post(std::uint32_t port, const std::string& target, const std::string& token,
                    const std::string& body) {
  Headers headers = {{"Content-Type", "application/json"}};
  if (!token.empty()) headers.emplace_back("Authorization", "Bearer " + token);
  return http_request(port, "POST", target, headers, body);
}

std::string exchange_bytes(std::uint32_t port, const std::string& bytes, milliseconds quiet) {
  const Socket socket(port);
  send_all(socket.fd(), bytes);
  std::string text;
  while (receive_some(socket.fd(), text, Clock::now() + quiet)) {
  }
  return text;
}

RawConnection::RawConnection(std::uint32_t port) : socket_(connect_to(port)) {}

RawConnection::~RawConnection() {
  ::close(socket_);
}

void RawConnection::send(const std::string& bytes) const {
  send_all(socket_, bytes);
}

std::string RawConnection::receive_head() const {
  std::string text;
  const Clock::time_point end = Clock::now() + hang_limit();
  while (text.find("\r\n\r\n") == std::string::npos && receive_some(socket_, text, end)) {
  }
  return text;
}

std::string RawConnection::receive_all() const {
  std::string text;
  const Clock::time_point end = Clock::now() + hang_limit();
  while (receive_some(socket_, text, end)) {
  }
  return text;
}

bool RawConnection::ends() const {
  std::string text;
  bool ended = false;
  const Clock::time_point end = Clock::now() + hang_limit();
  while (receive_some(socket_, text, end, &ended)) {
  }
  return ended;
}

Headers token_header(const std::string& token) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string shown = "topogeo, token.";
  for (const char byte : token) {
    shown += kDigits[static_cast<unsigned char>(byte) >> 4U];
    shown += kDigits[static_cast<unsigned char>(byte) & 0xfU];
  }
  return {{"Sec-WebSocket-Protocol", shown}};
}

WebSocketClient::WebSocketClient(std::uint32_t port, const Headers& headers)
    : socket_(connect_to(port)) {
  Headers all = headers;
  all.insert(all.end(), {{"Connection", "Upgrade"},
                         {"Upgrade", "websocket"},
                         {"Sec-WebSocket-Version", "13"},
                         {"Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="}});
  send_all(socket_, request_text(port, "GET", "/ws", all, {}));
  const Clock::time_point end = Clock::now() + hang_limit();
  std::size_t head = std::string::npos;
  while ((head = buffer_.find("\r\n\r\n")) == std::string::npos && fill(end)) {
  }
  const std::string status = buffer_.substr(0, buffer_.find("\r\n"));
  if (status.find(" 101 ") == std::string::npos) {
    ::close(socket_);
    throw std::runtime_error(status);
  }
  handshake_ = buffer_.substr(0, head + 2);
  buffer_.erase(0, head + 4);
}

WebSocketClient::~WebSocketClient() {
  ::close(socket_);
}

bool WebSocketClient::fill(Clock::time_point end) {
  return receive_some(socket_, buffer_, end, &ended_);
}

void WebSocketClient::send_text(const std::string& text) {
  send_frame(kText, text);
}

// The mask is zero, which is valid.
void WebSocketClient::send_frame(unsigned opcode, const std::string& payload) {
  constexpr std::size_t kShort = 126;
  std::string frame(1, static_cast<char>(0x80U | opcode));
  if (payload.size() < kShort) {
    frame += static_cast<char>(0x80U | payload.size());
  } else if (payload.size() <= 0xffff) {
    frame += static_cast<char>(0x80U | 126U);
    frame += static_cast<char>(payload.size() >> 8U);
    frame += static_cast<char>(payload.size() & 0xffU);
  } else {
    frame += static_cast<char>(0x80U | 127U);
    for (int shift = 56; shift >= 0; shift -= 8) {
      frame += static_cast<char>((payload.size() >> static_cast<unsigned>(shift)) & 0xffU);
    }
  }
  send_all(socket_, frame + std::string(4, '\0') + payload);
}

std::optional<std::string> WebSocketClient::receive(milliseconds timeout) {
  const Clock::time_point end = Clock::now() + timeout;
  const auto byte = [this](std::size_t at) { return static_cast<unsigned char>(buffer_.at(at)); };
  while (true) {
    std::size_t head = 2;
    std::uint64_t size = buffer_.size() < head ? 0 : byte(1) & 0x7fU;
    const std::size_t more = size == 126 ? 2 : (size == 127 ? 8 : 0);
    head += more;
    if (more > 0 && buffer_.size() >= head) {
      size = 0;
      for (std::size_t i = 0; i < more; ++i) size = (size << 8U) | byte(2 + i);
    }
    if (buffer_.size() < head || buffer_.size() - head < size) {
      if (!fill(end)) return std::nullopt;
      continue;
    }
    const unsigned opcode = byte(0) & 0x0fU;
    const bool final = (byte(0) & 0x80U) != 0;
    std::string payload = buffer_.substr(head, size);
    buffer_.erase(0, head + size);
    if (opcode == kText || opcode == kBinary || opcode == kContinuation) {
      message_ += payload;
      if (!final) continue;
      return std::exchange(message_, {});
    }
    if (opcode == kPing) send_frame(kPong, payload);
    if (opcode == kClose) {
      ended_ = true;
      return std::nullopt;
    }
  }
}

void PageModel::take(const std::string& text) {
  const nlohmann::json message = nlohmann::json::parse(text);
  if (!message.contains("channel")) {
    others.push_back(message);
    return;
  }
  const std::string channel = message["channel"];
  const std::uint64_t version = message["version"];
  if (message.contains("value")) {
    values[channel] = message["value"];
  } else {
    const std::uint64_t from = message["from"];
    if (from == 0) {
      tables[channel].clear();
      ++snapshots;
    } else if (from != versions[channel]) {
      throw std::runtime_error(channel + ": a delta on " + std::to_string(from) + ", held is " +
                               std::to_string(versions[channel]));
    }
    for (const auto& [key, object] : message["set"].items()) tables[channel][key] = object;
    for (const auto& key : message["gone"]) tables[channel].erase(key.get<std::string>());
  }
  versions[channel] = version;
}

}  // namespace topogeo::test
