// Readers that leave while a writer sends.
#include "fast_dds/reader_removal.hpp"

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

/// The built-in profiles, except that the flow controller's thread sends all samples of a replay;
/// otherwise it sends only repeated ones.
std::string write_profiles_of_asynchronous_replay() {
  std::string text(built_in_profiles());
  const auto find = [&text](const std::string& what, std::size_t from) {
    const std::size_t at = text.find(what, from);
    if (at == std::string::npos) throw std::runtime_error("the profiles have no " + what);
    return at;
  };
  const std::size_t writer = find("profile_name=\"sensor_replay_writer\"", 0);
  text.insert(find("<data_sharing>", writer),
              "<publishMode><kind>ASYNCHRONOUS</kind></publishMode>\n        ");
  std::string file = ::testing::TempDir() + random_partition() + ".xml";
  std::ofstream(file) << text;
  return file;
}

TEST(ReaderRemoval, AWriterGoesOnSendingWhenReadersLeave) {
  ParticipantOptions options = options_in(random_partition());
  options.profiles_file = write_profiles_of_asynchronous_replay();
  const Participant sender(options);
  const Participant receiver(options);
  std::filesystem::remove(options.profiles_file);
  Writer<msg::Scan> writer(sender, kReplayRole);
  Reader<msg::Scan> staying(receiver, {.role = std::string(kReplayRole)});
  ASSERT_TRUE(wait_for_peers(writer));

  auto scan = message<msg::Scan>();
  scan.ranges_m().resize(1'000);  // several packets
  std::atomic<bool> stop = false;
  std::atomic<std::uint64_t> sent = 0;
  std::thread sending([&] {
    while (!stop) sent += writer.write(scan) ? 1 : 0;
  });
  const auto wait_for_sent = [&](std::uint64_t count) {
    const std::uint64_t wanted = sent + count;
    return test::wait_for(
        "scans to be sent", [&] { return sent >= wanted; },
        [&] { staying.take([](const msg::Scan&, const SampleInfo&) {}); });
  };
  for (int i = 0; i < 100; ++i) {
    const Reader<msg::Scan> leaving(receiver, {.role = std::string(kReplayRole)});
    if (wait_for_peers(leaving) && wait_for_sent(10)) continue;
    // It holds its locks forever, so nothing of it can be destroyed.
    std::fprintf(stderr, "the writer stands still since reader %d left\n", i);
    std::_Exit(EXIT_FAILURE);
  }
  stop = true;
  sending.join();
}

}  // namespace
}  // namespace topogeo::messaging
