// Streams of valid telegrams with garbage between them yield every one of the telegrams, with any
// garbage and however the stream is split.
#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/sick_telegram.hpp"
#include "topogeo/support/random.hpp"

#include "sick_streams.hpp"

namespace topogeo::devices {
namespace {

Bytes random_telegram(support::Random& random) {
  const auto status = static_cast<std::uint8_t>(random.below(256));
  switch (random.below(3)) {
    case 0: {
      std::vector<std::uint16_t> words(random.below(2) == 0 ? 361 : 180);
      // Half of the scans are full of false starts.
      const bool hard = random.below(2) == 0;
      for (std::uint16_t& word : words) {
        word = hard ? std::uint16_t{0x8002} : static_cast<std::uint16_t>(random.below(8192));
      }
      return measured_values(words, status);
    }
    case 1:
      return sick_reply(0xB1, random_bytes(random, 200), status);
    default:
      return sick_reply(0xA0, Bytes{0}, status, 0x81);
  }
}

/// Random bytes, the start of a telegram, or a damaged telegram.
Bytes random_garbage(support::Random& random) {
  Bytes bytes = random_telegram(random);
  switch (random.below(4)) {
    case 0:
      return random_bytes(random, 100);
    case 1:
      bytes.resize(random.below(bytes.size()));
      return bytes;
    case 2:
      bytes.erase(bytes.begin(),
                  bytes.begin() + static_cast<std::ptrdiff_t>(1 + random.below(bytes.size())));
      return bytes;
    default:
      bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1 + random.below(255));
      return bytes;
  }
}

TEST(SickDecoderProperty, EveryValidTelegramIsFoundBetweenGarbage) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    support::Random random(seed);
    std::vector<Bytes> sent;
    Bytes stream;
    for (std::uint64_t i = 0, count = 1 + random.below(8); i < count; ++i) {
      if (random.below(4) != 0) append(stream, random_garbage(random));
      sent.push_back(random_telegram(random));
      append(stream, sent.back());
    }
    if (random.below(2) == 0) append(stream, random_garbage(random));
    SickDecoder decoder(SickDecoder::Listener::kHost, kByteGap_ns);
    std::vector<Bytes> found = decode(decoder, stream, 1 + random.below(1000));
    // Garbage may contain valid single bytes; it must yield nothing else.
    std::erase_if(found, [](const Bytes& event) { return event.size() == 1; });
    ASSERT_EQ(found, sent) << "seed " << seed;
    ASSERT_EQ(decoder.counters().telegrams, sent.size());
  }
}

TEST(SickDecoderProperty, TheCutOfTheStreamDoesNotMatter) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    support::Random random(seed);
    Bytes stream;
    for (int i = 0; i < 10; ++i) {
      append(stream, random.below(2) == 0 ? random_garbage(random) : random_telegram(random));
    }
    SickDecoder whole(SickDecoder::Listener::kHost, kByteGap_ns);
    SickDecoder parts(SickDecoder::Listener::kHost, kByteGap_ns);
    ASSERT_EQ(decode(parts, stream, 1 + random.below(20)), decode(whole, stream, stream.size() + 1))
        << "seed " << seed;
    ASSERT_EQ(parts.counters(), whole.counters()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace topogeo::devices
