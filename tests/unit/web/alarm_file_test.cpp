#include "channels/alarm_file.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/support/file_content.hpp"
#include "topogeo/support/temporary_folder.hpp"

#include "channels/alarm_list.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

Json shown(const ChannelHub& hub) {
  return Json::parse(*hub.update(Channel::kAlarms, 0).text)["set"];
}

class AlarmFileTest : public testing::Test {
 protected:
  /// The file as a service that was killed at this moment leaves it.
  [[nodiscard]] std::filesystem::path as_left() const {
    std::filesystem::path copy = folder_.path() / "left.jsonl";
    std::filesystem::copy_file(file_, copy, std::filesystem::copy_options::overwrite_existing);
    return copy;
  }

  support::TemporaryFolder folder_{"alarms"};
  std::filesystem::path file_ = folder_.path() / "new folder" / "alarms.jsonl";
};

TEST_F(AlarmFileTest, TheNextServiceGoesOnWithTheAlarmsOfAKilledOne) {
  ChannelHub hub;
  AlarmList alarms(hub, file_);
  alarms.raise(10 * kSecond_ns, "error", "base", "emergency stop");
  alarms.raise(11 * kSecond_ns, "warning", "laser", "offline");
  alarms.raise(12 * kSecond_ns, "warning", "laser", "offline");
  const std::vector<std::uint64_t> first = {1};
  alarms.acknowledge(20 * kSecond_ns, first, "Anna");

  ChannelHub next_hub;
  AlarmList next(next_hub, as_left());
  EXPECT_EQ(shown(next_hub), shown(hub));
  EXPECT_EQ(shown(next_hub)["1"]["acknowledged_by"], "Anna");
  next.raise(30 * kSecond_ns, "warning", "laser", "offline");
  EXPECT_EQ(shown(next_hub)["2"]["count"], 3) << "the same trouble, not yet acknowledged";
  next.raise(31 * kSecond_ns, "error", "base", "emergency stop");
  EXPECT_EQ(shown(next_hub)["3"]["acknowledged_by"], "") << "another alarm, with a new number";
}

TEST_F(AlarmFileTest, ALineThatWasCutCostsOnlyItself) {
  {
    ChannelHub hub;
    AlarmList alarms(hub, file_);
    alarms.raise(0, "error", "base", "offline");
    alarms.raise(0, "error", "laser", "offline");
  }
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 20);
  ChannelHub hub;
  AlarmList alarms(hub, file_);
  EXPECT_EQ(shown(hub).size(), 1U);
  EXPECT_EQ(shown(hub)["1"]["source"], "base");
  alarms.raise(0, "error", "laser", "offline");
  ChannelHub next_hub;
  const AlarmList next(next_hub, as_left());
  EXPECT_EQ(shown(next_hub), shown(hub));
}

TEST_F(AlarmFileTest, TheFileHasALimitAndForgetsAsThePageDoes) {
  ChannelHub hub;
  AlarmList alarms(hub, file_);
  const std::string long_text(200, 'x');
  std::uintmax_t largest = 0;
  for (std::size_t i = 1; i <= 6 * AlarmList::kKept; ++i) {
    alarms.raise(0, "warning", "base", long_text + std::to_string(i));
    largest = std::max(largest, std::filesystem::file_size(file_));
  }
  constexpr std::uintmax_t kMostOfLine_bytes = 400;
  EXPECT_LT(largest, kMostOfLine_bytes * (AlarmFile::kLinesPerAlarm + 1) * AlarmList::kKept);
  ChannelHub next_hub;
  const AlarmList next(next_hub, as_left());
  EXPECT_EQ(shown(next_hub).size(), AlarmList::kKept);
  EXPECT_EQ(shown(next_hub), shown(hub));
}

TEST_F(AlarmFileTest, RefusesAFileOfOtherContentAndLeavesIt) {
  std::filesystem::create_directories(file_.parent_path());
  std::ofstream(file_) << "a letter\n";
  ChannelHub hub;
  try {
    const AlarmList alarms(hub, file_);
    FAIL() << "expected an error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(file_.string()));
  }
  EXPECT_EQ(support::file_content(file_), "a letter\n");
}

TEST_F(AlarmFileTest, ReportsAnAlarmThatCannotBeWritten) {
  ChannelHub hub;
  int reports = 0;
  AlarmList alarms(hub, file_, [&] { ++reports; });
  alarms.raise(0, "error", "base", "offline");
  EXPECT_EQ(reports, 0);
  std::filesystem::remove_all(file_.parent_path());
  for (std::size_t i = 0; i <= AlarmFile::kLinesPerAlarm * AlarmList::kKept; ++i) {
    alarms.raise(0, "error", "base", "offline");
  }
  EXPECT_GT(reports, 0) << "the file cannot be replaced";
}

}  // namespace
}  // namespace topogeo::web
