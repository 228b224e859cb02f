#include "simulator/pseudo_terminal.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "topogeo/support/line_rate.hpp"

#include "services/simulator/host_port.hpp"

namespace topogeo::simulator {
namespace {

TEST(PseudoTerminal, CarriesBytesAsTheyAreBothWays) {
  PseudoTerminal terminal(link_name("bytes"));
  terminal.plug();
  const HostPort host(terminal.link());
  EXPECT_TRUE(terminal.receive().empty());
  std::string all;
  for (int byte = 0; byte < 256; ++byte) all.push_back(static_cast<char>(byte));
  host.write(all);
  const std::vector<std::uint8_t> heard = terminal.receive();
  EXPECT_EQ(std::string(heard.begin(), heard.end()), all);
  EXPECT_EQ(host.read(), "");  // no echo
  EXPECT_EQ(terminal.send(heard), 0U);
  EXPECT_EQ(host.read(), all);
}

TEST(PseudoTerminal, HandsOverAllThatWasWritten) {
  PseudoTerminal terminal(link_name("writes"));
  terminal.plug();
  const HostPort host(terminal.link());
  constexpr std::size_t kWrites = 6;
  const std::string part(1500, 'x');  // together more than a terminal delivers at once
  for (std::size_t i = 0; i < kWrites; ++i) host.write(part);
  EXPECT_EQ(terminal.receive().size(), kWrites * part.size());
}

TEST(PseudoTerminal, ShowsTheRateThatTheHostHasSet) {
  PseudoTerminal terminal(link_name("rate"));
  terminal.plug();
  EXPECT_EQ(terminal.host(devices::Parity::kEven),
            (devices::LineSettings{9600, devices::Parity::kEven}));
  const HostPort host(terminal.link());
  host.set_rate(B500000);
  EXPECT_EQ(terminal.host(devices::Parity::kNone).baud, 500'000U);
}

TEST(PseudoTerminal, HasRatesWithoutAConstantToo) {
  PseudoTerminal terminal(link_name("any_rate"));
  terminal.plug();
  const int host = ::open(terminal.link().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(host, 0);
  for (const std::uint32_t baud : {256'000U, 230'400U, 1'000'000U, 123'456U}) {
    EXPECT_TRUE(support::set_line_rate(host, baud));
    EXPECT_EQ(terminal.host(devices::Parity::kNone).baud, baud);
  }
  ::close(host);
  EXPECT_FALSE(support::set_line_rate(host, 9600));
}

TEST(PseudoTerminal, LosesWhatNobodyReads) {
  PseudoTerminal terminal(link_name("full"));
  terminal.plug();
  const std::vector<std::uint8_t> much(1'000'000, 7);
  EXPECT_GT(terminal.send(much), 0U);
}

TEST(PseudoTerminal, GoesAndComesBackUnderItsName) {
  const std::filesystem::path link = link_name("again");
  {
    PseudoTerminal terminal(link);
    terminal.plug();
    const HostPort host(link);
    EXPECT_FALSE(host.hung_up());
    terminal.unplug();
    EXPECT_TRUE(host.hung_up());
    EXPECT_FALSE(std::filesystem::is_symlink(link));
    terminal.plug();
    const HostPort again(link);
    again.write("x");
    EXPECT_EQ(terminal.receive().size(), 1U);
  }
  EXPECT_FALSE(std::filesystem::is_symlink(link));
}

TEST(PseudoTerminal, ReplacesALinkOfADeadSimulatorAndNothingElse) {
  const std::filesystem::path link = link_name("stale");
  std::filesystem::create_symlink("/nowhere", link);
  PseudoTerminal terminal(link);
  terminal.plug();
  EXPECT_NO_THROW(HostPort{link});
  terminal.unplug();
  std::ofstream(link) << "a file";
  EXPECT_THROW(terminal.plug(), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_regular_file(link));
  std::filesystem::remove(link);
}

std::size_t open_files() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(PseudoTerminal, APortThatCannotBeMadeLeavesNothingOpen) {
  PseudoTerminal terminal(link_name("nowhere").string() + "/port");  // in no directory
  const std::size_t before = open_files();
  for (int i = 0; i < 3; ++i) EXPECT_THROW(terminal.plug(), std::runtime_error);
  EXPECT_FALSE(terminal.plugged());
  EXPECT_EQ(open_files(), before);
}

}  // namespace
}  // namespace topogeo::simulator
