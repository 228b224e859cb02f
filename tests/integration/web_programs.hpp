// The web service and the programs that it needs.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "program.hpp"
#include "waiting.hpp"
#include "web_client.hpp"

namespace topogeo::test {

inline const std::chrono::milliseconds kPagePatience = hang_limit();
inline const std::string kToken = "token-of-this-test";

/// Port in the first link that a program prints.
inline std::uint32_t port_in(const std::string& out) {
  const std::size_t begin = out.find("127.0.0.1:");
  if (begin == std::string::npos) return 0;
  return static_cast<std::uint32_t>(std::stoul(out.substr(begin + 10)));
}

inline std::uint32_t wait_for_port(const Program& program) {
  if (!test::wait_for("the link to the page",
                      [&] { return program.out().find("spectators: ") != std::string::npos; })) {
    throw std::runtime_error("no link: " + program.err());
  }
  return port_in(program.out());
}

inline void keep_lines(const std::filesystem::path& file, std::size_t lines) {
  std::string text = read_file(file);
  std::size_t end = 0;
  for (std::size_t i = 0; i < lines && end < text.size(); ++i) {
    end = std::min(text.find('\n', end), text.size() - 1) + 1;
  }
  text.resize(end);
  std::ofstream(file) << text;
}

/// A map store that shows the map of a drive through a room, and a web service.
class WebOnMap : public testing::Test {
 protected:
  /// `lines`: number of lines of the drive's log to use.
  explicit WebOnMap(std::size_t lines = std::numeric_limits<std::size_t>::max()) {
    use_udp_only();
    write_log("room", scratch_ / "room.clf");
    keep_lines(scratch_ / "room.clf", lines);
    Program map(
        scratch_, "topogeo",
        {"map", "--log", (scratch_ / "room.clf").string(), "--out", (scratch_ / "room").string()});
    if (map.wait() != 0) throw std::runtime_error(map.err());
    start_store();
    start_web();
  }
  void start_store() {
    store_ =
        std::make_unique<Program>(scratch_, "map_store",
                                  std::vector<std::string>{"--domain", domain_, "--map",
                                                           (scratch_ / "room/map.pb").string()});
  }
  void start_web() {
    web_ = std::make_unique<Program>(
        scratch_, "web",
        std::vector<std::string>{"--domain", domain_, "--port", "0", "--token", kToken, "--memory",
                                 (scratch_ / "web.stop").string()});
    port_ = wait_for_port(*web_);
  }
  /// Whether the page has the whole map.
  static bool is_whole(PageModel& page) {
    return page.has("map") && page.has("tiles") && page.has("rooms") &&
           page.tables["graph"].contains("map");
  }

  Scratch scratch_;
  std::string domain_ = own_domain();
  std::unique_ptr<Program> store_;
  std::unique_ptr<Program> web_;
  std::uint32_t port_ = 0;
};

/// `topogeo demo --web`: all services with a simulated robot, in real time.
class WebOnRobot : public testing::Test {
 protected:
  WebOnRobot() {
    use_udp_only();
    demo_ = std::make_unique<Program>(
        scratch_, "topogeo",
        std::vector<std::string>{"demo", "--web", "--port", "0", "--token", kToken, "--out",
                                 (scratch_ / "demo").string(), "--domain", own_domain()});
    port_ = wait_for_port(*demo_);
    socket_ = std::make_unique<WebSocketClient>(port_);
    socket_->send({{"op", "hello"}, {"token", kToken}});
  }
  template <class Condition>
  bool wait_for(const Condition& condition, std::chrono::milliseconds patience = kPagePatience) {
    return page_.wait_for(*socket_, condition, patience);
  }
  /// True position of the robot, world frame.
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
