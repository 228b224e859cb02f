// Several writers of one instance, for example a stranger beside a peer: none may displace the
// samples of another one in a reader.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "fixture.hpp"
#include "waiting.hpp"

namespace topogeo::messaging {
namespace {

class SeveralWriters : public TwoParticipants {
 protected:
  template <class T>
  static void write(Writer<T>& writer, std::uint64_t number) {
    ASSERT_TRUE(writer.write(message<T>(number)));
  }
  /// Sequence numbers of the pending samples, by writer in the order of their first sample.
  template <class T>
  static std::vector<std::vector<std::uint64_t>> waiting(Reader<T>& reader) {
    std::map<Handle, std::size_t> writers;
    std::vector<std::vector<std::uint64_t>> numbers;
    reader.take([&](const T& got, const SampleInfo& info) {
      const std::size_t writer = writers.emplace(info.writer, writers.size()).first->second;
      numbers.resize(writers.size());
      numbers[writer].push_back(got.sequence_number());
    });
    return numbers;
  }
  /// Takes samples until there are events of this kind.
  template <class T>
  static bool wait_for_event(Reader<T>& reader, EventKind kind) {
    bool seen = false;
    return test::wait_for(to_string(kind), [&] {
      reader.take_events([&](const Event& event) { seen = seen || event.kind == kind; });
      return seen;
    });
  }

  /// Writes one sample of a peer, then as many of a stranger as the reader keeps of an instance,
  /// all before the program takes the first.
  template <class T>
  void expect_kept(std::uint64_t depth) {
    Reader<T> reader(receiver_);
    Writer<T> peer(sender_);
    Writer<T> stranger(stranger_);
    ASSERT_TRUE(peer.wait_for_matched(1, test::hang_limit()));
    ASSERT_TRUE(stranger.wait_for_matched(1, test::hang_limit()));
    write(peer, 1'000'000);
    ASSERT_TRUE(peer.wait_for_acknowledgments(test::hang_limit()));
    std::vector<std::uint64_t> strange;
    for (std::uint64_t i = 0; i < depth; ++i) {
      write(stranger, i);
      strange.push_back(i);
    }
    ASSERT_TRUE(stranger.wait_for_acknowledgments(test::hang_limit()));
    EXPECT_EQ(waiting(reader), (std::vector<std::vector<std::uint64_t>>{{1'000'000}, strange}))
        << reader.core()->topic();
  }

  Participant stranger_{options_in(partition_)};
};

TEST_F(SeveralWriters, ASampleOfAStrangerTakesNoPlaceOfAPeers) {
  expect_kept<msg::GridTile>(1);              // state
  expect_kept<msg::WorkerStatus>(1);          // status
  expect_kept<msg::MotionCommand>(1);         // command
  expect_kept<msg::LocalizationCommand>(64);  // request
  expect_kept<msg::Scan>(100);                // sensor_live
  expect_kept<msg::Odometry>(200);            // motion_live
}

TEST_F(SeveralWriters, OfEachTheNewestIsPassedOn) {
  Reader<msg::GridTile> reader(receiver_);
  Writer<msg::GridTile> old_store(sender_);
  Writer<msg::GridTile> new_store(stranger_);
  ASSERT_TRUE(old_store.wait_for_matched(1, test::hang_limit()));
  ASSERT_TRUE(new_store.wait_for_matched(1, test::hang_limit()));
  for (std::uint64_t version = 0; version < 100; ++version) {
    write(old_store, version);
    write(new_store, 1'000 + version);
  }
  ASSERT_TRUE(old_store.wait_for_acknowledgments(test::hang_limit()));
  ASSERT_TRUE(new_store.wait_for_acknowledgments(test::hang_limit()));
  auto numbers = waiting(reader);
  std::ranges::sort(numbers);
  EXPECT_EQ(numbers, (std::vector<std::vector<std::uint64_t>>{{99}, {1'099}}));
}

TEST_F(SeveralWriters, APeersInstanceOutlivesAStrangerWhoWroteIt) {
  Reader<msg::GridTile> reader(receiver_);
  Writer<msg::GridTile> peer(sender_);
  std::optional<Writer<msg::GridTile>> stranger(stranger_);
  ASSERT_TRUE(peer.wait_for_matched(1, test::hang_limit()));
  ASSERT_TRUE(stranger->wait_for_matched(1, test::hang_limit()));
  write(peer, 1);
  ASSERT_TRUE(peer.wait_for_acknowledgments(test::hang_limit()));
  write(*stranger, 2);
  ASSERT_TRUE(stranger->wait_for_acknowledgments(test::hang_limit()));
  ASSERT_EQ(waiting(reader).size(), 2U);

  stranger.reset();  // its last writer
  ASSERT_TRUE(wait_for_event(reader, EventKind::kUnmatched));
  reader.take([](const msg::GridTile&, const SampleInfo& info) {
    ADD_FAILURE() << "the peer still has it, state " << static_cast<int>(info.state);
  });
}

TEST_F(SeveralWriters, WhoHadNothingAcceptedEndsNoInstance) {
  Reader<msg::GridTile> reader(receiver_);
  Writer<msg::GridTile> peer(sender_);
  Writer<msg::GridTile> stranger(stranger_);
  ASSERT_TRUE(peer.wait_for_matched(1, test::hang_limit()));
  ASSERT_TRUE(stranger.wait_for_matched(1, test::hang_limit()));
  constexpr std::uint64_t kRefused = 7;
  constexpr std::uint64_t kRefusedAndReported = 8;
  std::vector<InstanceState> ends;
  const auto take = [&] {
    reader.take([&](const msg::GridTile& got, const SampleInfo& info) {
      if (!info.valid) {
        ends.push_back(info.state);
      } else if (got.sequence_number() == kRefused) {
        throw std::invalid_argument("absurd");
      } else if (got.sequence_number() == kRefusedAndReported) {
        throw Refused();
      }
    });
  };
  write(peer, 1);
  ASSERT_TRUE(peer.wait_for_acknowledgments(test::hang_limit()));
  for (const std::uint64_t refused : {kRefused, kRefusedAndReported}) {
    write(stranger, refused);
    ASSERT_TRUE(stranger.wait_for_acknowledgments(test::hang_limit()));
    take();
  }
  stranger.dispose(message<msg::GridTile>());
  ASSERT_TRUE(stranger.wait_for_acknowledgments(test::hang_limit()));
  take();
  EXPECT_TRUE(ends.empty());

  peer.dispose(message<msg::GridTile>());
  ASSERT_TRUE(peer.wait_for_acknowledgments(test::hang_limit()));
  take();
  EXPECT_EQ(ends, std::vector<InstanceState>{InstanceState::kDisposed});
}

// A stranger whose samples were all refused does not keep the instance alive.
TEST_F(SeveralWriters, APeersInstanceEndsWithItBesideAStrangerWhoWasRefused) {
  Reader<msg::GridTile> reader(receiver_);
  std::optional<Writer<msg::GridTile>> peer(sender_);
  Writer<msg::GridTile> stranger(stranger_);
  ASSERT_TRUE(peer->wait_for_matched(1, test::hang_limit()));
  ASSERT_TRUE(stranger.wait_for_matched(1, test::hang_limit()));
  std::vector<InstanceState> ends;
  const auto take = [&] {
    reader.take([&](const msg::GridTile& got, const SampleInfo& info) {
      if (!info.valid) {
        ends.push_back(info.state);
      } else if (got.sequence_number() > 1) {
        throw Refused();
      }
    });
  };
  write(*peer, 1);
  ASSERT_TRUE(peer->wait_for_acknowledgments(test::hang_limit()));
  write(stranger, 2);
  ASSERT_TRUE(stranger.wait_for_acknowledgments(test::hang_limit()));
  take();
  peer.reset();
  ASSERT_TRUE(wait_for_event(reader, EventKind::kUnmatched));
  take();
  EXPECT_EQ(ends, std::vector<InstanceState>{InstanceState::kNoWriters});
}

// They share memory of the middleware, whose limit is the sum of theirs.
TEST_F(SeveralWriters, AProgramMayHaveManyReadersOfATopic) {
  std::vector<Reader<msg::ServiceStatus>> readers;
  readers.reserve(60);
  for (int i = 0; i < 60; ++i) readers.emplace_back(receiver_);
  Writer<msg::ServiceStatus> writer(sender_);
  ASSERT_TRUE(writer.wait_for_matched(60, test::hang_limit()));
  write(writer, 1);
  for (auto& reader : readers) {
    std::uint64_t number = 0;
    EXPECT_TRUE(test::wait_for("a sample at each reader", [&] {
      reader.take([&](const msg::ServiceStatus& got, const SampleInfo&) {
        number = got.sequence_number();
      });
      return number == 1;
    }));
  }
}

// Threads of the middleware collect samples, and may be doing so at that moment.
TEST_F(SeveralWriters, AReaderEndsWhileSamplesArrive) {
  Writer<msg::GridTile> peer(sender_);
  Writer<msg::GridTile> stranger(stranger_);
  std::atomic<bool> stop = false;
  const auto write_on = [&stop](Writer<msg::GridTile>& writer) {
    for (std::uint64_t i = 0; !stop; ++i)
      static_cast<void>(writer.write(message<msg::GridTile>(i)));
  };
  std::thread first(write_on, std::ref(peer));
  std::thread second(write_on, std::ref(stranger));
  for (int i = 0; i < 50; ++i) {
    EventLoop loop;
    Reader<msg::GridTile> reader(receiver_);
    loop.add<msg::GridTile>(reader,
                            [&loop](const msg::GridTile&, const SampleInfo&) { loop.stop(); });
    EXPECT_TRUE(loop.run_for(test::hang_limit())) << i;
  }
  stop = true;
  first.join();
  second.join();
}

}  // namespace
}  // namespace topogeo::messaging
