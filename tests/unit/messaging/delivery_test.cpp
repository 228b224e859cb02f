// Delivery of samples: late readers, slow readers, disposals, addressees, partitions.
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

using Delivery = TwoParticipants;

msg::MapElement element(std::uint32_t id) {
  auto result = message<msg::MapElement>();
  result.kind(msg::kElementNode);
  result.id(id);
  return result;
}

TEST_F(Delivery, LateReaderGetsTheLastStateOfEachInstance) {
  Writer<msg::TrajectorySegment> writer(sender_);
  for (std::uint64_t version = 1; version <= 3; ++version) {
    for (std::uint32_t segment = 0; segment < 2; ++segment) {
      auto sample = message<msg::TrajectorySegment>();
      sample.segment(segment);
      sample.version(version);
      ASSERT_TRUE(writer.write(sample));
    }
  }
  Reader<msg::TrajectorySegment> reader(receiver_);
  std::map<std::uint32_t, std::vector<std::uint64_t>> versions;
  ASSERT_TRUE(test::wait_for("both segments", [&] {
    reader.take([&](const msg::TrajectorySegment& got, const SampleInfo&) {
      versions[got.segment()].push_back(got.version());
    });
    return versions.size() == 2;
  }));
  EXPECT_EQ(versions[0], std::vector<std::uint64_t>{3});
  EXPECT_EQ(versions[1], std::vector<std::uint64_t>{3});
}

TEST_F(Delivery, ThousandsOfInstancesReachALateReader) {
  constexpr std::uint32_t kInstances = 3'000;
  Writer<msg::MapElement> writer(sender_);
  for (std::uint32_t id = 0; id < kInstances; ++id) ASSERT_TRUE(writer.write(element(id)));
  Reader<msg::MapElement> reader(receiver_);
  std::set<std::uint32_t> ids;
  std::set<Handle> handles;
  EXPECT_TRUE(test::wait_for("all instances", [&] {
    reader.take([&](const msg::MapElement& got, const SampleInfo& info) {
      ids.insert(got.id());
      handles.insert(info.instance);
    });
    return ids.size() == kInstances;
  }));
  EXPECT_EQ(ids.size(), kInstances);
  EXPECT_EQ(handles.size(), kInstances);
}

TEST_F(Delivery, ThousandsOfLocalMapsReachALateReader) {
  constexpr std::uint32_t kMaps = 3'000;
  Writer<msg::LocalMap> writer(sender_);
  for (std::uint32_t id = 0; id < kMaps; ++id) {
    auto map = message<msg::LocalMap>();
    map.id(id);
    map.points().resize(361);
    ASSERT_TRUE(writer.write(map));
  }
  Reader<msg::LocalMap> reader(receiver_);
  std::set<std::uint32_t> ids;
  EXPECT_TRUE(test::wait_for("all local maps", [&] {
    reader.take([&](const msg::LocalMap& got, const SampleInfo&) { ids.insert(got.id()); });
    return ids.size() == kMaps;
  }));
}

TEST_F(Delivery, SlowReaderSlowsAReplayAndLosesNothing) {
  constexpr std::uint64_t kScans = 500;
  Writer<msg::Scan> writer(sender_, kReplayRole);
  Reader<msg::Scan> reader(receiver_, {.role = std::string(kReplayRole)});
  ASSERT_TRUE(wait_for_peers(writer));
  ASSERT_TRUE(wait_for_peers(reader));

  std::atomic<std::uint64_t> refused = 0;
  std::thread replay([&] {
    for (std::uint64_t i = 0; i < kScans; ++i) {
      auto scan = message<msg::Scan>(i);
      scan.ranges_m().assign(361, 1.0F);
      while (!writer.write(scan)) ++refused;
    }
  });
  // Both histories are full by then.
  EXPECT_TRUE(test::wait_for("the reader to hold the writer back", [&] { return refused > 0; }));
  std::vector<std::uint64_t> sequence_numbers;
  EXPECT_TRUE(test::wait_for("all scans", [&] {
    reader.take([&](const msg::Scan& got,
                    const SampleInfo&) { sequence_numbers.push_back(got.sequence_number()); },
                1);
    return sequence_numbers.size() == kScans;
  }));
  replay.join();

  for (std::uint64_t i = 0; i < sequence_numbers.size(); ++i) EXPECT_EQ(sequence_numbers[i], i);
}

TEST_F(Delivery, DisposalNamesTheInstanceByItsHandle) {
  Writer<msg::MapElement> writer(sender_);
  Reader<msg::MapElement> reader(receiver_);
  ASSERT_TRUE(wait_for_peers(writer));
  for (std::uint32_t id = 0; id < 3; ++id) ASSERT_TRUE(writer.write(element(id)));
  std::map<Handle, std::uint32_t> id_of;
  const auto take = [&](auto&& on_gone) {
    reader.take([&](const msg::MapElement& got, const SampleInfo& info) {
      if (info.valid) {
        id_of[info.instance] = got.id();
      } else {
        on_gone(got, info);
      }
    });
  };
  ASSERT_TRUE(test::wait_for("three elements", [&] {
    take([](const auto&, const auto&) { ADD_FAILURE() << "nothing was disposed yet"; });
    return id_of.size() == 3;
  }));

  writer.dispose(element(1));

  std::vector<std::uint32_t> gone;
  ASSERT_TRUE(test::wait_for("a disposal", [&] {
    take([&](const msg::MapElement& got, const SampleInfo& info) {
      EXPECT_EQ(info.state, InstanceState::kDisposed);
      EXPECT_EQ(got.schema_version(), 0U);  // no leftovers of an earlier sample
      gone.push_back(id_of.at(info.instance));
    });
    return !gone.empty();
  }));
  EXPECT_EQ(gone, std::vector<std::uint32_t>{1});

  Participant late(options_in(partition_));
  Reader<msg::MapElement> late_reader(late);
  std::set<std::uint32_t> ids;
  EXPECT_TRUE(test::wait_for("the two elements that are left", [&] {
    late_reader.take([&](const msg::MapElement& got, const SampleInfo& info) {
      if (info.valid) ids.insert(got.id());
    });
    return ids.size() == 2;
  }));
  EXPECT_EQ(ids, (std::set<std::uint32_t>{0, 2}));

  ASSERT_TRUE(writer.write(element(1)));  // and it may come back
  EXPECT_TRUE(test::wait_for("the element that came back", [&] {
    bool back = false;
    reader.take([&](const msg::MapElement& got, const SampleInfo& info) {
      back = back || (info.valid && got.id() == 1);
    });
    return back;
  }));
}

TEST_F(Delivery, EverNewInstancesDoNotUseUpTheLimit) {
  Writer<msg::MapElement> writer(sender_);
  Reader<msg::MapElement> reader(receiver_);
  ASSERT_TRUE(wait_for_peers(writer));
  constexpr std::uint32_t kMoreThanTheLimit = 40'000;  // max_instances of role state: 32,768
  std::set<Handle> alive;
  std::uint32_t arrived = 0;
  const auto take = [&] {
    reader.take([&](const msg::MapElement& got, const SampleInfo& info) {
      if (info.valid) {
        arrived = std::max(arrived, got.id());
        alive.insert(info.instance);
      } else {
        alive.erase(info.instance);
      }
    });
  };
  for (std::uint32_t id = 0; id < kMoreThanTheLimit; ++id) {
    ASSERT_TRUE(test::wait_for("room for an element", [&] { return writer.write(element(id)); }))
        << id;
    if (id > 0) writer.dispose(element(id - 1));
    take();
  }
  EXPECT_TRUE(test::wait_for("the last element, alone",
                             [&] {
                               take();
                               return arrived == kMoreThanTheLimit - 1 && alive.size() == 1;
                             }))
      << arrived << " " << alive.size();
}

TEST_F(Delivery, TasksReachOnlyTheWorkerTheyAreAddressedTo) {
  Writer<msg::MatchTasks> writer(sender_);
  Reader<msg::MatchTasks> one(receiver_, {.addressee = "one"});
  Reader<msg::MatchTasks> two(receiver_, {.addressee = "two"});
  ASSERT_TRUE(wait_for_peers(writer, 2));
  for (std::uint64_t i = 0; i < 30; ++i) {
    auto task = message<msg::MatchTasks>(i);
    set_worker_id(task, i % 3 == 0 ? "one" : "two");
    ASSERT_TRUE(writer.write(task));
  }
  std::vector<std::uint64_t> ids_one;
  std::vector<std::uint64_t> ids_two;
  EXPECT_TRUE(test::wait_for("ten and twenty tasks", [&] {
    one.take([&](const msg::MatchTasks& t, const SampleInfo&) {
      ids_one.push_back(t.sequence_number());
    });
    two.take([&](const msg::MatchTasks& t, const SampleInfo&) {
      ids_two.push_back(t.sequence_number());
    });
    return ids_one.size() >= 10 && ids_two.size() >= 20;
  }));
  EXPECT_EQ(ids_one, (std::vector<std::uint64_t>{0, 3, 6, 9, 12, 15, 18, 21, 24, 27}));
  EXPECT_EQ(ids_two.size(), 20U);
  EXPECT_TRUE(wait_for_acknowledgments(writer));
}

// The filter results of all readers once were in every message, which then exceeded a packet.
TEST_F(Delivery, ATaskReachesOneOfVeryManyWorkers) {
  constexpr std::size_t kWorkers = 64;
  Writer<msg::MatchTasks> writer(sender_);
  std::vector<std::unique_ptr<Reader<msg::MatchTasks>>> workers;
  for (std::size_t i = 0; i < kWorkers; ++i) {
    workers.push_back(std::make_unique<Reader<msg::MatchTasks>>(
        receiver_, ReaderOptions{.addressee = "worker " + std::to_string(i)}));
  }
  ASSERT_TRUE(wait_for_peers(writer, static_cast<int>(kWorkers)));
  auto task = message<msg::MatchTasks>();
  set_worker_id(task, "worker 63");
  ASSERT_TRUE(writer.write(task));
  std::size_t taken = 0;
  EXPECT_TRUE(test::wait_for("the task", [&] {
    workers.back()->take([&](const msg::MatchTasks&, const SampleInfo&) { ++taken; });
    return taken == 1;
  }));
  workers.front()->take([&](const msg::MatchTasks&, const SampleInfo&) { ++taken; });
  EXPECT_EQ(taken, 1U);
}

/// Addressed messages reach their addressee for any alignment of the fields before the address.
template <class T, class SetAddressee>
void expect_addressed(const Participant& sender, const Participant& receiver,
                      const SetAddressee& set_addressee) {
  Writer<T> writer(sender);
  Reader<T> me(receiver, {.addressee = "me"});
  Reader<T> mee(receiver, {.addressee = "mee"});
  ASSERT_TRUE(wait_for_peers(writer, 2));
  std::vector<std::string> for_me;
  std::vector<std::string> for_mee;
  constexpr std::size_t kLongest = 9;
  for (std::size_t length = 0; length <= kLongest; ++length) {
    for (const char* who : {"me", "mee", "m", ""}) {
      T sent;
      set_header(sent, std::string(length, 'r'), 1, length);
      set_addressee(sent, who);
      ASSERT_TRUE(writer.write(sent));
    }
    for_me.push_back(std::string(length, 'r'));
  }
  for_mee = for_me;
  std::vector<std::string> got_me;
  std::vector<std::string> got_mee;
  EXPECT_TRUE(test::wait_for("the messages of both addressees", [&] {
    me.take([&](const T& t, const SampleInfo&) { got_me.push_back(t.robot_id().to_string()); });
    mee.take([&](const T& t, const SampleInfo&) { got_mee.push_back(t.robot_id().to_string()); });
    return got_me.size() >= for_me.size() && got_mee.size() >= for_mee.size();
  }));
  EXPECT_EQ(got_me, for_me);
  EXPECT_EQ(got_mee, for_mee);
}

TEST_F(Delivery, EveryAddressedTopicReachesTheAddresseeAlone) {
  const auto set_worker = [](auto& message, const char* who) { set_worker_id(message, who); };
  const auto set_client = [](auto& message, const char* who) { set_client_id(message, who); };
  expect_addressed<msg::MatchTasks>(sender_, receiver_, set_worker);
  expect_addressed<msg::MapCopy>(sender_, receiver_, [&](auto& message, auto who) {
    set_worker(message, who);
    message.local_map().schema_version(msg::kSchemaVersion);
  });
  expect_addressed<msg::MatchResults>(sender_, receiver_, set_client);
  expect_addressed<msg::MapRequest>(sender_, receiver_, set_client);
}

TEST_F(Delivery, AddresseeMayHaveQuotes) {
  const std::string name = "it's \"me\"";
  Writer<msg::MatchTasks> writer(sender_);
  Reader<msg::MatchTasks> reader(receiver_, {.addressee = name});
  ASSERT_TRUE(wait_for_peers(writer));
  auto task = message<msg::MatchTasks>();
  set_worker_id(task, name);
  ASSERT_TRUE(writer.write(task));
  EXPECT_TRUE(wait_for_data(reader));
}

TEST_F(Delivery, AddresseeOnATopicWithoutOneIsAnError) {
  EXPECT_THROW(Reader<msg::Goal>(receiver_, {.addressee = "me"}), std::runtime_error);
}

TEST_F(Delivery, PartitionsDoNotSeeEachOtherButTheWildcardSeesAll) {
  Participant stranger(options_in(random_partition()));
  Participant observer(options_in(kAnyPartition));
  Writer<msg::Goal> writer(sender_);
  Reader<msg::Goal> same(receiver_);
  Reader<msg::Goal> other(stranger);
  Reader<msg::Goal> any(observer);
  ASSERT_TRUE(wait_for_peers(writer, 2));
  ASSERT_TRUE(writer.write(message<msg::Goal>()));
  ASSERT_TRUE(wait_for_data(same));
  ASSERT_TRUE(wait_for_data(any));
  EXPECT_EQ(writer.matched(), 2);
  EXPECT_EQ(other.matched(), 0);
  EXPECT_EQ(other.take([](const msg::Goal&, const SampleInfo&) {}), 0U);
}

// Each sample is split into packets, and a late reader gets it with its own address, for which (and
// for the key) Fast DDS reserves no space (libs/messaging/src/fast_dds/fragments.cpp).
TEST(DeliveryInPackets, LargeSamplesReachALateReader) {
  constexpr std::uint32_t kMaps = 20;
  ParticipantOptions options = options_in(random_partition());
  options.profile = "udp_only";
  const Participant sender(options);
  const Participant receiver(options);
  Writer<msg::LocalMap> writer(sender);
  for (std::uint32_t id = 0; id < kMaps; ++id) {
    auto map = message<msg::LocalMap>();
    map.id(id);
    map.branches().resize(100 + id);
    for (msg::LocalBranch& branch : map.branches()) branch.points().resize(40);
    ASSERT_TRUE(writer.write(map));
  }
  for (int late = 0; late < 2; ++late) {
    Reader<msg::LocalMap> reader(receiver);
    std::set<std::uint32_t> ids;
    EXPECT_TRUE(test::wait_for("all large local maps", [&] {
      reader.take([&](const msg::LocalMap& got, const SampleInfo&) {
        EXPECT_EQ(got.branches().size(), 100U + got.id());
        ids.insert(got.id());
      });
      return ids.size() == kMaps;
    }));
  }
}

TEST(DeliveryInPackets, OfLargeSamplesThatAreReplacedTheLastOnesArrive) {
  constexpr std::uint32_t kInstances = 8;
  constexpr std::uint64_t kSamples = 50;
  ParticipantOptions options = options_in(random_partition());
  options.profile = "udp_only";
  const Participant sender(options);
  const Participant receiver(options);
  Writer<msg::TrajectorySegment> writer(sender);
  Reader<msg::TrajectorySegment> reader(receiver);
  ASSERT_TRUE(wait_for_peers(writer));
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    auto segment = message<msg::TrajectorySegment>(i);
    segment.segment(static_cast<std::uint32_t>(i % kInstances));
    segment.segment(0xFFFFFFF0U + segment.segment());
    segment.stops().resize(msg::kSegmentStops);
    ASSERT_TRUE(writer.write(segment));
    // Pacing: some packets of a sample are sent before the next one replaces it.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::set<std::uint64_t> last;
  EXPECT_TRUE(test::wait_for("the last sample of each instance", [&] {
    reader.take([&](const msg::TrajectorySegment& got, const SampleInfo&) {
      EXPECT_EQ(got.stops().size(), msg::kSegmentStops);
      if (got.sequence_number() + kInstances >= kSamples) last.insert(got.sequence_number());
    });
    return last.size() == kInstances;
  })) << last.size();
}

}  // namespace
}  // namespace topogeo::messaging
