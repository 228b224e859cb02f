#include "topogeo/planning/grid_file.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class GridFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / "topogeo_grid_file" / info->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

  // Writes a valid pair of files, with one line of the YAML replaced.
  void write_pair(const std::string& key = "", const std::string& line = "") const {
    std::string yaml;
    for (const std::string& good :
         {std::string("image: floor.pgm"), std::string("resolution: 0.1"),
          std::string("origin: [1, 2, 0]"), std::string("negate: 0"),
          std::string("occupied_thresh: 0.65"), std::string("free_thresh: 0.196")}) {
      yaml += (!key.empty() && good.starts_with(key) ? line : good) + "\n";
    }
    write("floor.yaml", yaml);
    write("floor.pgm", "P2\n# drawn by hand\n3 2\n255\n254 205 0\n254 254 0\n");
  }

  void expect_message(const std::string& first, const std::string& second) const {
    EXPECT_THAT([&] { read_grid(folder_ / "floor.yaml"); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(first), HasSubstr(second))));
  }

  std::filesystem::path folder_;
};

TEST_F(GridFile, ReadsTheImageFromTheTop) {
  write_pair();
  const OccupancyGrid grid = read_grid(folder_ / "floor.yaml");
  EXPECT_EQ(grid.frame().columns, 3);
  EXPECT_EQ(grid.frame().rows, 2);
  EXPECT_EQ(grid.frame().T_map_grid, (geometry::Pose2{1.0, 2.0, 0.0}));
  EXPECT_EQ(grid.at({0, 1}), CellState::kFree);
  EXPECT_EQ(grid.at({1, 1}), CellState::kUnknown);
  EXPECT_EQ(grid.at({2, 1}), CellState::kOccupied);
  EXPECT_EQ(grid.at({1, 0}), CellState::kFree);
}

TEST_F(GridFile, NegateTurnsDarkAndLightRound) {
  write_pair("negate", "negate: 1");
  const OccupancyGrid grid = read_grid(folder_ / "floor.yaml");
  EXPECT_EQ(grid.at({0, 1}), CellState::kOccupied);
  EXPECT_EQ(grid.at({2, 1}), CellState::kFree);
}

TEST_F(GridFile, ReadsBackWhatItWrote) {
  support::Random random(3);
  GridFrame frame;
  frame.columns = 37;
  frame.rows = 11;
  frame.resolution_m = 0.05;
  frame.T_map_grid = {-1.0 / 3.0, 17.25, 0.7};
  OccupancyGrid grid(frame);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    grid.set(frame.cell_at(i), static_cast<CellState>(random.below(3)));
  }
  for (const PgmForm form : {PgmForm::kBinary, PgmForm::kText}) {
    write_grid(folder_ / "a b.yaml", grid, form);
    const OccupancyGrid again = read_grid(folder_ / "a b.yaml");
    EXPECT_EQ(again.frame().T_map_grid, frame.T_map_grid);
    EXPECT_EQ(again.frame().resolution_m, frame.resolution_m);
    ASSERT_EQ(again.frame().columns, frame.columns);
    EXPECT_TRUE(std::ranges::equal(again.cells(), grid.cells()));
  }
}

TEST_F(GridFile, NamesTheLineAndTheRangeOfABadValue) {
  write_pair("resolution", "resolution: 7");
  expect_message("floor.yaml:2: resolution: expected a number from 0.01 to 1 m", "got '7'");
  write_pair("origin", "origin: [1, 2]");
  expect_message("floor.yaml:3: origin: expected [x, y, yaw]", "a list of 2");
  write_pair("origin", "origin: [1, .nan, 0]");
  expect_message("floor.yaml:3", "origin y");
  write_pair("free_thresh", "free_thresh: 0.7");
  expect_message("floor.yaml:6: free_thresh", "0 to 0.65");
  write_pair("negate", "negate: maybe");
  expect_message("floor.yaml:4: negate", "'maybe'");
  write_pair("negate", "negative: 0");
  expect_message("floor.yaml:4: key", "'negative'");
  write_pair("negate", "");
  expect_message("floor.yaml", "key 'negate' is missing");
  write_pair("negate", "negate: 0\nnegate: 0");
  expect_message("floor.yaml:5", "each key once");
  write_pair("negate", "negate: [");
  expect_message("floor.yaml:", "");
  write_pair("negate", "negate: 0\nmode: scale");
  expect_message("mode: expected trinary", "'scale'");
}

TEST_F(GridFile, NamesWhatIsWrongWithAnImage) {
  write_pair();
  write("floor.pgm", "P6\n3 2\n255\n");
  expect_message("floor.pgm", "must begin with P2 or P5");
  write("floor.pgm", "P2\n3 0\n255\n1 2 3");
  expect_message("floor.pgm", "height is not a whole number from 1 to 20000");
  write("floor.pgm", "P5\n3 2\n65535\n");
  expect_message("floor.pgm", "maximum value is not a whole number from 1 to 255");
  write("floor.pgm", "P5\n3 2\n255\nabc");
  expect_message("floor.pgm", "cut short: expected 6 pixels");
  write("floor.pgm", "P2\n3 2\n255\n1 2 3 4 5");
  expect_message("floor.pgm", "cut short");
  write("floor.pgm", "P2\n3 2\n255\n1 2 3 4 5 256");
  expect_message("floor.pgm", "pixel 5 is not a whole number from 0 to 255");
  write("floor.pgm", "P5\n3 2\n99\nabcdef");
  expect_message("floor.pgm", "pixel 3 is 100");
  write("floor.pgm", "P5\n20000 20000\n255\n");
  expect_message("floor.pgm", "400000000 pixels");
  write("floor.pgm", "");
  expect_message("floor.pgm", "must begin with");
}

TEST_F(GridFile, SaysWhichFileIsNotThere) {
  expect_message("floor.yaml", "No such file");
  write_pair();
  std::filesystem::remove(folder_ / "floor.pgm");
  expect_message("floor.pgm", "No such file");
}

}  // namespace
}  // namespace topogeo::planning
