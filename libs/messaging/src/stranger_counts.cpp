#include "stranger_counts.hpp"

#include <atomic>

#include "topogeo/messaging/strangers.hpp"

namespace topogeo::messaging {

namespace {

std::atomic<std::uint64_t> g_invalid = 0;
std::atomic<std::uint64_t> g_unprotected = 0;
std::atomic<std::uint64_t> g_security_errors = 0;
std::atomic<std::uint64_t> g_denied_samples = 0;
std::atomic<std::uint64_t> g_unknown_topics = 0;
std::atomic<std::uint64_t> g_forged_removals = 0;

}  // namespace

void count_invalid_packet() {
  g_invalid.fetch_add(1, std::memory_order_relaxed);
}

void count_unprotected_packet() {
  g_unprotected.fetch_add(1, std::memory_order_relaxed);
}

void count_security_error() {
  g_security_errors.fetch_add(1, std::memory_order_relaxed);
}

void count_denied_sample() {
  g_denied_samples.fetch_add(1, std::memory_order_relaxed);
}

void count_unknown_topic() {
  g_unknown_topics.fetch_add(1, std::memory_order_relaxed);
}

void count_forged_removals(std::uint64_t count) {
  g_forged_removals.fetch_add(count, std::memory_order_relaxed);
}

StrangerCounts stranger_counts() {
  return {.invalid_packets = g_invalid.load(std::memory_order_relaxed),
          .unprotected_packets = g_unprotected.load(std::memory_order_relaxed),
          .security_errors = g_security_errors.load(std::memory_order_relaxed),
          .denied_samples = g_denied_samples.load(std::memory_order_relaxed),
          .unknown_topics = g_unknown_topics.load(std::memory_order_relaxed),
          .forged_removals = g_forged_removals.load(std::memory_order_relaxed)};
}

}  // namespace topogeo::messaging
