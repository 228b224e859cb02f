#include "localizer/stop_table.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "topogeo/pipeline/localization_run.hpp"

namespace topogeo::localizer {
namespace {

namespace fs = std::filesystem;

std::string text_in(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class StopTableTest : public testing::Test {
 protected:
  ~StopTableTest() override { fs::remove(file_); }

  /// Stops `first` to `end` - 1 of a drive.
  static std::vector<localization::LocalizedStop> stops(std::uint32_t first, std::uint32_t end) {
    std::vector<localization::LocalizedStop> out(end - first);
    for (std::uint32_t i = first; i < end; ++i) {
      out[i - first].stop.number = i;
      out[i - first].T_map_robot.x_m = i;
    }
    return out;
  }

  fs::path file_ =
      fs::path(testing::TempDir()) / ("stop_table_" + std::to_string(::getpid()) + ".csv");
};

TEST_F(StopTableTest, HasEveryStopThoughOldOnesAreForgotten) {
  StopTable table(file_);
  table.add({{}, 0});
  for (std::uint32_t added = 1; added <= 50; ++added) {
    const auto known = stops(added < 20 ? 0 : added - 10, added);
    table.add({known, added});
    EXPECT_FALSE(fs::exists(file_)) << "before the end";
  }
  table.finish({stops(40, 50), 50});
  EXPECT_EQ(text_in(file_), pipeline::localization_csv(stops(0, 50)));
  EXPECT_FALSE(fs::exists(file_.string() + ".part"));
}

TEST_F(StopTableTest, TheLastStopIsWrittenWithThePoseThatItHasAtTheEnd) {
  StopTable table(file_);
  auto drive = stops(0, 3);
  table.add({drive, 3});
  drive[2].T_map_robot.x_m = 7.5;  // the pose was set by hand
  table.finish({drive, 3});
  EXPECT_EQ(text_in(file_), pipeline::localization_csv(drive));
}

TEST_F(StopTableTest, SaysThatItCannotWrite) {
  EXPECT_THROW(StopTable("/no/such/folder/table.csv"), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::localizer
