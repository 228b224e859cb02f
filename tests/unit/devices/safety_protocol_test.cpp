// Data sets of SICK safety scanners, their fragments, and CoLa 2 telegrams.
#include "topogeo/devices/safety_protocol.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;
using Bytes = std::vector<std::uint8_t>;

SafetyScan a_scan(std::size_t beams) {
  SafetyScan scan;
  scan.serial_number = 7;
  scan.channel = 1;
  scan.sequence = 42;
  scan.scan = 43;
  scan.time_ms = 1000;
  scan.state.emplace();
  scan.state->safe_paths = 0b110;
  scan.state->contamination_warning = true;
  scan.scan_time_ms = 30;
  scan.first = -100;
  scan.step = 200;
  for (std::size_t i = 0; i < beams; ++i) {
    scan.beams.push_back({static_cast<std::uint16_t>(1000 + i), kSafetyValid});
  }
  scan.intruding = {3, 0};
  return scan;
}

TEST(SafetyData, ADataSetIsReadAsItWasWritten) {
  const auto read = safety_scan(safety_data(a_scan(40)));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->serial_number, 7U);
  EXPECT_EQ(read->channel, 1);
  EXPECT_EQ(read->sequence, 42U);
  EXPECT_EQ(read->time_ms, 1000U);
  EXPECT_EQ(read->first, -100);
  EXPECT_EQ(read->step, 200);
  ASSERT_EQ(read->beams.size(), 40U);
  EXPECT_EQ(read->beams[39].distance, 1039);
  EXPECT_THAT(read->intruding, ElementsAre(3U, 0U));
  ASSERT_TRUE(read->state);
  EXPECT_EQ(read->state->safe_paths, 0b110U);
  EXPECT_TRUE(read->state->contamination_warning);
  EXPECT_FALSE(read->state->device_error);
}

// Worked by hand from the tables of the maker's document.
TEST(SafetyData, FieldsLieWhereTheDocumentPutsThem) {
  const Bytes data = safety_data(a_scan(2));
  EXPECT_EQ(data[12], 1);  // channel
  EXPECT_THAT(Bytes(data.begin() + 16, data.begin() + 20), ElementsAre(42, 0, 0, 0));
  EXPECT_THAT(Bytes(data.begin() + 32, data.begin() + 36), ElementsAre(52, 0, 16, 0));
  EXPECT_THAT(Bytes(data.begin() + 36, data.begin() + 40), ElementsAre(68, 0, 24, 0));
  EXPECT_THAT(Bytes(data.begin() + 40, data.begin() + 44), ElementsAre(92, 0, 12, 0));
  EXPECT_EQ(data[52], 0b101);  // run mode, contamination warning
  EXPECT_EQ(data[53], 0b110);  // safe paths
  EXPECT_THAT(Bytes(data.begin() + 92, data.begin() + 104),
              ElementsAre(2, 0, 0, 0, 0xE8, 3, 0, 1, 0xE9, 3, 0, 1));
}

TEST(SafetyData, WrongSizesAreRefused) {
  const Bytes data = safety_data(a_scan(10));
  for (std::size_t size = 0; size < data.size(); ++size) {
    EXPECT_FALSE(safety_scan(std::span(data).first(size))) << size << " bytes";
  }
  Bytes forged = data;
  forged[42] = 0xFF;  // size of the measurements
  forged[43] = 0xFF;
  EXPECT_FALSE(safety_scan(forged));
  forged = data;
  forged[92] = 11;  // beams
  EXPECT_FALSE(safety_scan(forged));
}

class SafetyFragments : public testing::Test {
 protected:
  const Bytes data_ = safety_data(a_scan(1000));
  std::vector<Bytes> datagrams_ = safety_datagrams(data_, 9);
  SafetyAssembler assembler_;
};

TEST_F(SafetyFragments, OneDatagramIsADataSet) {
  const Bytes small = safety_data(a_scan(10));
  const auto datagrams = safety_datagrams(small, 1);
  ASSERT_EQ(datagrams.size(), 1U);
  EXPECT_EQ(assembler_.add(datagrams.front()), small);
}

TEST_F(SafetyFragments, AnyOrderAndDuplicatesGiveOneDataSet) {
  ASSERT_EQ(datagrams_.size(), 4U);
  std::vector<std::size_t> order{0, 1, 2, 3};
  std::uint32_t identification = 10;
  do {
    const auto datagrams = safety_datagrams(data_, ++identification);
    std::size_t complete = 0;
    for (const std::size_t i : order) {
      for (int copy = 0; copy < 2; ++copy) {
        const auto data = assembler_.add(datagrams[i]);
        if (!data) continue;
        EXPECT_EQ(*data, data_);
        ++complete;
      }
    }
    EXPECT_EQ(complete, 1U);
  } while (std::ranges::next_permutation(order).found);
  EXPECT_EQ(assembler_.repeated(), 24U * 4U);
  EXPECT_EQ(assembler_.incomplete(), 0U);
}

TEST_F(SafetyFragments, ALostFragmentLosesItsDataSetAlone) {
  for (std::uint32_t set = 0; set < 5; ++set) {
    auto datagrams = safety_datagrams(data_, 100 + set);
    datagrams.pop_back();
    for (const Bytes& datagram : datagrams) EXPECT_FALSE(assembler_.add(datagram));
  }
  EXPECT_EQ(assembler_.incomplete(), 1U);  // four may still be completed
  std::size_t complete = 0;
  for (const Bytes& datagram : datagrams_) complete += assembler_.add(datagram) ? 1 : 0;
  EXPECT_EQ(complete, 1U);
}

TEST_F(SafetyFragments, ForgedPlacesAndLengthsAreRefused) {
  const auto forged = [this](std::size_t at, std::uint8_t value) {
    Bytes datagram = datagrams_[1];
    datagram[at] = value;
    return assembler_.add(datagram);
  };
  EXPECT_FALSE(forged(11, 1));     // 16 MB
  EXPECT_FALSE(forged(19, 0xFF));  // far behind the end
  EXPECT_FALSE(forged(17, 0xFF));
  EXPECT_FALSE(forged(0, 'X'));
  EXPECT_FALSE(assembler_.add(std::span(datagrams_[0]).first(kSafetyHead)));
  EXPECT_EQ(assembler_.foreign(), 5U);
  // A fragment that overlaps another one changes nothing.
  EXPECT_FALSE(assembler_.add(datagrams_[0]));
  EXPECT_FALSE(forged(16, 0x10));  // begins within the first
  std::size_t complete = 0;
  for (std::size_t i = 1; i < datagrams_.size(); ++i) {
    const auto data = assembler_.add(datagrams_[i]);
    if (!data) continue;
    EXPECT_EQ(*data, data_);
    ++complete;
  }
  EXPECT_EQ(complete, 1U);
}

// The document's example recalls variable 177.
TEST(Cola2, TheExampleOfTheDocumentIsWritten) {
  EXPECT_THAT(
      cola2_bytes({0xD82EB727, 3, 'R', 'I', {0xB1, 0}}),
      ElementsAre(2, 2, 2, 2, 0, 0, 0, 12, 0, 0, 0xD8, 0x2E, 0xB7, 0x27, 0, 3, 'R', 'I', 0xB1, 0));
}

TEST(Cola2, TelegramsAreFoundWhereverTheyAreCut) {
  Bytes bytes{1, 2, 9};
  const Bytes first = cola2_bytes({5, 1, 'O', 'A', {}});
  const Bytes second = cola2_bytes({5, 2, 'A', 'I', {1, 2, 3}});
  bytes.insert(bytes.end(), first.begin(), first.end());
  bytes.insert(bytes.end(), second.begin(), second.end());
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    Cola2Reader reader;
    auto found = reader.read(std::span(bytes).first(cut));
    for (auto& telegram : reader.read(std::span(bytes).subspan(cut))) {
      found.push_back(std::move(telegram));
    }
    ASSERT_EQ(found.size(), 2U) << "cut at " << cut;
    EXPECT_EQ(found[0].type, 'O');
    EXPECT_EQ(found[1].request, 2);
    EXPECT_THAT(found[1].data, ElementsAre(1, 2, 3));
    EXPECT_EQ(reader.noise_bytes(), 3U);
  }
}

TEST(Cola2, TheDataOutputIsReadAsItWasWritten) {
  const Bytes data = safety_configuration({2, 4, 0xC0A80001, 6060});
  EXPECT_EQ(data.size(), 30U);
  EXPECT_THAT(Bytes(data.begin() + 10, data.begin() + 16),
              ElementsAre(1, 0, 168, 192, 6060 & 0xFF, 6060 >> 8));
  const auto output = safety_output(data);
  ASSERT_TRUE(output);
  EXPECT_EQ(output->channel, 2);
  EXPECT_EQ(output->address, 0xC0A80001U);
  EXPECT_EQ(output->port, 6060);
  EXPECT_FALSE(safety_output(Bytes(29)));
}

}  // namespace
}  // namespace topogeo::devices
