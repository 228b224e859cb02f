// An operator's stop of a base that reports nothing: restarts, and orders that arrive late.
#include "topogeo/service/operator_stop.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "full_disk.hpp"

namespace topogeo::service {
namespace {

constexpr std::uint64_t kFirstStop = 11;
constexpr std::uint64_t kSecondStop = 22;

messaging::Handle writer_handle(std::uint8_t number) {
  messaging::Handle handle;
  handle.bytes[0] = number;
  return handle;
}

msg::BaseCommand base_order(msg::BaseCommandKind kind, std::uint64_t number) {
  msg::BaseCommand command;
  command.kind(kind);
  command.stop_count(number);
  return command;
}

class OperatorStopTest : public testing::Test {
 protected:
  OperatorStopTest() { std::filesystem::remove(path_); }
  ~OperatorStopTest() override { std::filesystem::remove(path_); }

  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / "topogeo_operator_stop_test";
  const messaging::Handle page_ = writer_handle(1);
  const messaging::Handle other_page_ = writer_handle(2);
};

TEST_F(OperatorStopTest, HoldsInTheNextProcessUntilTheRelease) {
  EXPECT_FALSE(OperatorStop(path_).holds());
  OperatorStop(path_).hold(kFirstStop);
  EXPECT_TRUE(OperatorStop(path_).holds());
  EXPECT_EQ(OperatorStop(path_).number(), kFirstStop);
  OperatorStop(path_).release();
  EXPECT_FALSE(OperatorStop(path_).holds());
  EXPECT_EQ(OperatorStop(path_).number(), kFirstStop) << "the one that was released";
}

TEST_F(OperatorStopTest, OfAnotherProgramEndsByItsReleaseAlone) {
  OperatorStop stop(path_);
  EXPECT_TRUE(stop.take(base_order(msg::kBaseHalt, kFirstStop), page_));
  EXPECT_FALSE(stop.take(base_order(msg::kBaseHalt, kSecondStop), other_page_)) << "holds already";
  EXPECT_FALSE(stop.take(base_order(msg::kBaseSetLimits, kSecondStop), page_));
  // It was sent before the second stop, by a link that was cut.
  EXPECT_FALSE(stop.take(base_order(msg::kBaseReset, kFirstStop), page_));
  EXPECT_TRUE(stop.holds());
  EXPECT_TRUE(OperatorStop(path_).holds());
  EXPECT_TRUE(stop.take(base_order(msg::kBaseReset, kSecondStop), page_));
  EXPECT_FALSE(stop.holds());
  EXPECT_FALSE(OperatorStop(path_).holds());
}

// A page that hears a base names the stop that the base counts.
TEST_F(OperatorStopTest, IsReleasedByItsOwnWriterWhateverNumberItNames) {
  OperatorStop stop(path_);
  EXPECT_TRUE(stop.take(base_order(msg::kBaseHalt, kFirstStop), page_));
  EXPECT_FALSE(stop.take(base_order(msg::kBaseReset, 3), other_page_));
  EXPECT_TRUE(stop.take(base_order(msg::kBaseReset, 3), page_));
  EXPECT_FALSE(stop.holds());
}

// The base is offline: it takes halt and reset, and reports no stop meanwhile.
TEST_F(OperatorStopTest, IsReleasedByAResetThatNamesTheCountOfTheBase) {
  constexpr std::uint64_t kBefore = 30;
  constexpr std::uint64_t kCount = 31;
  OperatorStop(path_).hold(kFirstStop);
  OperatorStop stop(path_);
  EXPECT_FALSE(stop.take(base_order(msg::kBaseReset, 0), page_)) << "it names no stop";
  stop.base_counts(kCount);
  EXPECT_FALSE(stop.take(base_order(msg::kBaseReset, kBefore), page_)) << "sent before the stop";
  EXPECT_TRUE(stop.take(base_order(msg::kBaseReset, kCount), page_));
  EXPECT_FALSE(stop.holds());
}

TEST_F(OperatorStopTest, RepeatedAfterItsReleaseStopsNothing) {
  OperatorStop stop(path_);
  EXPECT_TRUE(stop.take(base_order(msg::kBaseHalt, kFirstStop), page_));
  EXPECT_TRUE(stop.take(base_order(msg::kBaseReset, kFirstStop), other_page_));
  EXPECT_FALSE(stop.take(base_order(msg::kBaseHalt, kFirstStop), page_));
  EXPECT_FALSE(stop.holds());
  EXPECT_TRUE(stop.take(base_order(msg::kBaseHalt, kSecondStop), page_));
  EXPECT_TRUE(stop.holds());
}

// Two programs, two links.
TEST_F(OperatorStopTest, OvertakenByItsReleaseStopsNothing) {
  OperatorStop stop(path_);
  EXPECT_FALSE(stop.take(base_order(msg::kBaseReset, kFirstStop), other_page_));
  EXPECT_FALSE(stop.take(base_order(msg::kBaseHalt, kFirstStop), page_));
  EXPECT_FALSE(stop.holds());
}

TEST_F(OperatorStopTest, IsOverWhenTheBaseHoldsItself) {
  OperatorStop stop(path_);
  stop.hold(kFirstStop);
  stop.hand_over();
  EXPECT_FALSE(stop.holds());
  EXPECT_FALSE(OperatorStop(path_).holds());
  // A gateway that starts again needs the same stop once more.
  EXPECT_TRUE(stop.take(base_order(msg::kBaseHalt, kFirstStop), page_));
}

TEST_F(OperatorStopTest, ADamagedFileStops) {
  OperatorStop(path_).release();
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_TRUE(OperatorStop(path_).holds());
  EXPECT_TRUE(OperatorStop(path_).holds()) << "over one more start";
  OperatorStop(path_).release();
  EXPECT_FALSE(OperatorStop(path_).holds());
}

TEST_F(OperatorStopTest, ThatCannotBeWrittenHoldsAllTheSame) {
  OperatorStop stop(path_);
  {
    const test::FullDisk full(8);
    stop.hold(kFirstStop);
    EXPECT_TRUE(stop.holds());
  }
  EXPECT_TRUE(OperatorStop(path_).holds());
}

TEST_F(OperatorStopTest, WithoutAFileNothingIsKept) {
  OperatorStop stop{std::filesystem::path()};
  stop.hold(kFirstStop);
  EXPECT_TRUE(stop.holds());
  EXPECT_FALSE(OperatorStop(std::filesystem::path()).holds());
  EXPECT_THROW(OperatorStop("/nowhere/at/all"), std::runtime_error);
}

TEST_F(OperatorStopTest, HasTheAgeOfAStopOfBeforeTheStart) {
  EXPECT_FALSE(OperatorStop(path_).age_at_start());
  OperatorStop(path_).hold(kFirstStop);
  const auto now = std::filesystem::last_write_time(path_);
  std::filesystem::last_write_time(path_, now - std::chrono::hours(5));
  const auto age = OperatorStop(path_).age_at_start();
  ASSERT_TRUE(age);
  EXPECT_GE(*age, std::chrono::hours(5));
  OperatorStop(path_).release();
  EXPECT_FALSE(OperatorStop(path_).age_at_start());
}

TEST(AgeOfAStop, IsInWords) {
  using namespace std::chrono_literals;
  EXPECT_EQ(age_in_words(std::nullopt), "");
  EXPECT_EQ(age_in_words(119s), "119 s ago");
  EXPECT_EQ(age_in_words(125s), "2 min ago");
  EXPECT_EQ(age_in_words(5h + 59min), "5 h ago");
  EXPECT_EQ(age_in_words(50h), "2 days ago");
}

TEST(OperatorStopNumber, IsNeverTheSame) {
  const std::uint64_t number = OperatorStop::new_number();
  EXPECT_NE(number, 0U);
  EXPECT_NE(number, OperatorStop::new_number());
}

}  // namespace
}  // namespace topogeo::service
