// The web service and what it needs as programs.
#pragma once

#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "program.hpp"
#include "web_client.hpp"

namespace topogeo::test {

inline constexpr std::chrono::milliseconds kPagePatience{60'000};
inline const std::string kToken = "token-of-this-test";

/// Of the first link that a program prints.
inline std::uint32_t port_in(const std::string& out) {
  const std::size_t begin = out.find("127.0.0.1:");
  if (begin == std::string::npos) return 0;
  return static_cast<std::uint32_t>(std::stoul(out.substr(begin + 10)));
}

inline std::uint32_t wait_for_port(const Program& program,
                                   std::chrono::milliseconds patience = kPagePatience) {
  const auto end = std::chrono::steady_clock::now() + patience * kTimeFactor;
  while (std::chrono::steady_clock::now() < end) {
    if (program.out().find("spectators: ") != std::string::npos) return port_in(program.out());
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw std::runtime_error("no link: " + program.err());
}

/// `topogeo demo --web`: all services with a simulated robot, in real time.
class WebOnRobot : public testing::Test {
 protected:
  WebOnRobot() {
    use_udp_only();
    demo_ = std::make_unique<Program>(
        scratch_, "topogeo",
        std::vector<std::string>{"demo", "--web", "--port", "0", "--token", kToken, "--out",
                                 (scratch_ / "demo").string(), "--domain", own_domain()});
    port_ = wait_for_port(*demo_, std::chrono::milliseconds(90'000));
    socket_ = std::make_unique<WebSocketClient>(port_);
    socket_->send({{"op", "hello"}, {"token", kToken}});
  }
  template <class Condition>
  bool wait_for(const Condition& condition, std::chrono::milliseconds patience = kPagePatience) {
    return page_.wait_for(*socket_, condition, patience * kTimeFactor);
  }
  /// In the world.
  std::pair<double, double> truth() {
    return {page_.values["truth"]["x_m"], page_.values["truth"]["y_m"]};
  }
  static double distance(const std::pair<double, double>& a, const std::pair<double, double>& b) {
    return std::hypot(a.first - b.first, a.second - b.second);
  }

  Scratch scratch_;
  std::unique_ptr<Program> demo_;
  std::uint32_t port_ = 0;
  std::unique_ptr<WebSocketClient> socket_;
  PageModel page_;
};

}  // namespace topogeo::test
