// From a pose message to a page: how long, with one viewer and with many, while the service shows a
// map.
//
//   topogeo_web_latency [VIEWERS...]        default: 1 20
//
// This process is the localizer, and the pages, in a domain of its own.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/trajectory.h"
#include "topogeo/support/format.hpp"

#include "program.hpp"
#include "web_client.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kPoses = 300;
constexpr milliseconds kPosePeriod{50};

std::uint32_t wait_for_port(const topogeo::test::Program& web) {
  while (web.out().find("spectators: ") == std::string::npos) {
    std::this_thread::sleep_for(milliseconds(20));
  }
  return static_cast<std::uint32_t>(
      std::stoul(web.out().substr(web.out().find("127.0.0.1:") + 10)));
}

/// When each pose came to a page.
class Page {
 public:
  explicit Page(std::uint32_t port) : socket_(port), thread_([this] { read(); }) {}
  void join() { thread_.join(); }
  [[nodiscard]] const std::map<std::uint64_t, Clock::time_point>& came() const { return came_; }

 private:
  void read() {
    while (const auto text = socket_.receive(milliseconds(3000))) {
      const Clock::time_point now = Clock::now();
      if (text->find(R"("channel":"pose")") == std::string::npos) continue;
      const std::size_t at = text->find(R"("sequence":)");
      const std::uint64_t number = std::stoull(text->substr(at + 11));
      came_.emplace(number, now);
      if (number + 1 == kPoses) return;
    }
  }
  topogeo::test::WebSocketClient socket_;
  std::map<std::uint64_t, Clock::time_point> came_;
  std::thread thread_;  // last: it uses the others
};

void measure(int viewers, messaging::Writer<msg::LivePose>& poses, std::uint32_t port) {
  std::vector<std::unique_ptr<Page>> pages;
  pages.reserve(static_cast<std::size_t>(viewers));
  for (int i = 0; i < viewers; ++i) pages.push_back(std::make_unique<Page>(port));
  std::this_thread::sleep_for(milliseconds(500));
  std::vector<Clock::time_point> sent;
  Clock::time_point due = Clock::now();
  for (std::uint64_t i = 0; i < kPoses; ++i) {
    msg::LivePose pose;
    messaging::set_header(pose, "robot", static_cast<std::int64_t>(i) * 50'000'000, i);
    pose.state(msg::kStateTracking);
    pose.T_map_robot().x_m(0.01 * static_cast<double>(i));
    sent.push_back(Clock::now());
    static_cast<void>(poses.write(pose));
    due += kPosePeriod;
    std::this_thread::sleep_until(due);
  }
  std::vector<double> latencies_ms;
  for (const auto& page : pages) {
    page->join();
    for (const auto& [number, time] : page->came()) {
      latencies_ms.push_back(
          std::chrono::duration<double, std::milli>(time - sent.at(number)).count());
    }
  }
  std::ranges::sort(latencies_ms);
  const auto quantile = [&](double share) {
    return latencies_ms.at(
        static_cast<std::size_t>(share * static_cast<double>(latencies_ms.size() - 1)));
  };
  std::cout << fmt::format("| {} | {} of {} | {:.2f} | {:.2f} | {:.2f} |\n", viewers,
                           latencies_ms.size(), viewers * kPoses, quantile(0.5), quantile(0.95),
                           latencies_ms.back());
}

void run(const std::vector<int>& viewers) {
  const topogeo::test::Scratch scratch;
  const std::string domain = topogeo::test::own_domain();
  const topogeo::test::Program web(scratch, "web", {"--domain", domain, "--port", "0"});
  const std::uint32_t port = wait_for_port(web);
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain));
  const messaging::Participant participant(options);
  messaging::Writer<msg::LivePose> poses(participant);
  if (!poses.wait_for_matched(1, std::chrono::seconds(20)))
    throw std::runtime_error("no web service");
  std::cout
      << "| viewers | poses received | median ms | 95 % ms | largest ms |\n|---|---|---|---|---|\n";
  for (const int count : viewers) measure(count, poses, port);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::vector<int> viewers;
    for (int i = 1; i < argc; ++i) viewers.push_back(std::atoi(argv[i]));
    if (viewers.empty()) viewers = {1, 20};
    run(viewers);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
