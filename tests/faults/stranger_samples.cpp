// A stranger that uses DDS in domain 0 until SIGTERM: fifty times a second, samples of absurd
// content and malformed samples on all topics, or a new topic that does not exist.
//
//   stranger_samples absurd | topics
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <thread>

#include "stranger.hpp"

namespace topogeo::test {
namespace {

constexpr std::chrono::milliseconds kPeriod{20};
/// After so many topics it leaves with all of them and returns as a new participant.
constexpr std::size_t kTopicsAtOnce = 300;

volatile std::sig_atomic_t g_samples_stopped = 0;

void write_absurd_samples() {
  messaging::ParticipantOptions options;
  options.partition = "*";
  options.name = "stranger";
  const messaging::Participant participant(options);
  AbsurdSamples samples(participant, options.domain);
  NoMessages no_messages(options.domain);
  std::uint64_t rounds = 0;
  for (; g_samples_stopped == 0; ++rounds) {
    samples.write(rounds);
    no_messages.write(rounds);
    std::this_thread::sleep_for(kPeriod);  // pacing: services need time for their own work
  }
  std::cout << rounds << " samples on each topic" << std::endl;
}

void write_unknown_topics() {
  std::optional<UnknownTopics> topics;
  std::uint64_t written = 0;
  for (; g_samples_stopped == 0; ++written) {
    if (!topics || topics->size() == kTopicsAtOnce) topics.emplace(0);
    topics->add();
    std::this_thread::sleep_for(kPeriod);  // pacing, as above
  }
  std::cout << written << " topics" << std::endl;
}

int run(const std::string& what) {
  std::signal(SIGTERM, [](int) { g_samples_stopped = 1; });
  if (what == "absurd") {
    write_absurd_samples();
  } else if (what == "topics") {
    write_unknown_topics();
  } else {
    std::cerr << "usage: stranger_samples absurd | topics\n";
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace topogeo::test

int main(int argc, char** argv) {
  try {
    return topogeo::test::run(argc == 2 ? argv[1] : "");
  } catch (const std::exception& error) {
    std::cerr << "stranger_samples: " << error.what() << '\n';
    return 1;
  }
}
