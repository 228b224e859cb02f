#include "topogeo/storage/relations.hpp"

#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;

using Relations = ScratchDirectory;

/// Message of the exception on parsing this text.
std::string complaint(const std::string& text) {
  try {
    (void)parse_relations(text, "r");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST_F(Relations, ReadsStampsAndTheParts) {
  const auto read = parse_relations(
      "# t1 t2 x y z roll pitch yaw\n"
      "\n"
      "1134864643.33319 1134864643.553180001 0.09172 -2 9 8 7 0.25\r\n"
      " 5 3.5\t1e1 0 0 0 0 3.5\n",
      "r");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].stamp_a_ns, 1'134'864'643'333'190'000);
  EXPECT_EQ(read[0].stamp_b_ns, 1'134'864'643'553'180'001);
  EXPECT_EQ(read[0].T_a_b, (geometry::Pose2{0.09172, -2.0, 0.25}));
  EXPECT_EQ(read[1].stamp_b_ns, 3'500'000'000);  // backwards in time is permitted
  EXPECT_DOUBLE_EQ(read[1].T_a_b.x_m, 10.0);
  EXPECT_NEAR(read[1].T_a_b.theta_rad, 3.5 - 2.0 * std::numbers::pi, 1e-12);
}

TEST_F(Relations, NamesFileLineAndField) {
  const std::string good = "1 2 0 0 0 0 0 0\n";
  EXPECT_THAT(complaint(good + "x 2 0 0 0 0 0 0\n"), HasSubstr("r:2: t1 'x'"));
  EXPECT_THAT(complaint("# 1\n\n1 1e9 0 0 0 0 0 0\n"), HasSubstr("r:3: t2 '1e9'"));
  EXPECT_THAT(complaint("1 2 0 nan 0 0 0 0\n"), HasSubstr("r:1: y 'nan'"));
  EXPECT_THAT(complaint("1 2 0 0 0 0 0\n"), HasSubstr("r:1: yaw ''"));
  EXPECT_THAT(complaint("1 2 0 0 0 0 0 0 0\n"), HasSubstr("more than the 8 numbers"));
  EXPECT_THAT(complaint("1 2 0 0 0 0 0 1e9\n"), HasSubstr("r:1: yaw 1"));
}

TEST_F(Relations, ReadsAFileAndNamesAMissingOne) {
  std::ofstream(directory_ / "a") << "1 2 3 4 5 6 7 0.5";
  const auto read = read_relations(directory_ / "a");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].T_a_b, (geometry::Pose2{3.0, 4.0, 0.5}));
  try {
    (void)read_relations(directory_ / "none");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr((directory_ / "none").string()));
  }
}

}  // namespace
}  // namespace topogeo::storage
