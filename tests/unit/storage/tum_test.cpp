#include "topogeo/storage/tum.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;

using Tum = ScratchDirectory;

TEST_F(Tum, PrintsStampsExactly) {
  EXPECT_EQ(stamp_text(0), "0.000000");
  EXPECT_EQ(stamp_text(1'234'567'000), "1.234567");
  EXPECT_EQ(stamp_text(1'234'567'001), "1.234567001");
  EXPECT_EQ(stamp_text(1'700'000'000'000'000'010), "1700000000.000000010");
  EXPECT_EQ(stamp_text(-1), "-0.000000001");
  EXPECT_EQ(stamp_text(-2'500'000'000), "-2.500000");
  EXPECT_EQ(stamp_text(std::numeric_limits<std::int64_t>::min()), "-9223372036.854775808");
}

TEST_F(Tum, WritesOneLinePerPose) {
  const std::vector<topomap::StampedPose> poses{
      {0, 1'000'000'000, {0.0, -1e-9, 0.0}},
      {1, 2'500'000'000, {1.25, -2.0, std::numbers::pi / 2}},
      {2, 3'000'000'001, {0.0, 0.0, -std::numbers::pi}}};
  EXPECT_EQ(trajectory_tum(poses),
            "1.000000 0.000000 0.000000 0.000000 0.000000000 0.000000000 0.000000000 1.000000000\n"
            "2.500000 1.250000 -2.000000 0.000000 0.000000000 0.000000000 0.707106781 0.707106781\n"
            "3.000000001 0.000000 0.000000 0.000000 0.000000000 0.000000000 -1.000000000 "
            "0.000000000\n");
}

TEST_F(Tum, ReadsBackWhatItWrote) {
  std::vector<topomap::StampedPose> poses;
  poses.reserve(60);
  for (int i = 0; i < 60; ++i) {
    poses.push_back({static_cast<std::uint64_t>(i),
                     1'700'000'000'123'456'789 + i,
                     {0.37 * i, -1.1 * i, -3.1 + 0.1 * i}});
  }
  write_trajectory_tum(directory_ / "a.tum", poses);
  const auto read = read_trajectory_tum(directory_ / "a.tum");
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].sequence, i);
    EXPECT_EQ(read[i].stamp_ns, poses[i].stamp_ns);
    EXPECT_NEAR(read[i].pose.x_m, poses[i].pose.x_m, 1e-6);
    EXPECT_NEAR(read[i].pose.y_m, poses[i].pose.y_m, 1e-6);
    EXPECT_NEAR(read[i].pose.theta_rad, poses[i].pose.theta_rad, 1e-8);
  }
}

TEST_F(Tum, ReadsFilesOfOthers) {
  // Comments, empty lines, Windows line ends, blanks, varying decimals, exponents, a tilt.
  const auto poses = parse_trajectory_tum(
      "# t x y z qx qy qz qw\n\n"
      "  12 1e0\t2 0.5 0 0 0 -1\r\n"
      "12.1234567891234 1 2 0 0 0 1 0",
      "a.tum");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].stamp_ns, 12'000'000'000);
  EXPECT_EQ(poses[0].pose.theta_rad, 0.0);
  EXPECT_EQ(poses[1].stamp_ns, 12'123'456'789);
  EXPECT_DOUBLE_EQ(std::abs(poses[1].pose.theta_rad), std::numbers::pi);
  EXPECT_TRUE(parse_trajectory_tum("", "a.tum").empty());
}

TEST_F(Tum, NamesTheLineThatIsWrong) {
  const auto error = [](const std::string& line) {
    return error_of([&] { parse_trajectory_tum("1 0 0 0 0 0 0 1\n" + line + "\n", "a.tum"); });
  };
  EXPECT_THAT(error("x 0 0 0 0 0 0 1"), HasSubstr("a.tum:2: stamp 'x'"));
  EXPECT_THAT(error("1e9 0 0 0 0 0 0 1"), HasSubstr("a.tum:2: stamp '1e9'"));
  EXPECT_THAT(error("99999999999 0 0 0 0 0 0 1"), HasSubstr("stamp"));
  EXPECT_THAT(error("1 nan 0 0 0 0 0 1"), HasSubstr("a.tum:2: x 'nan'"));
  EXPECT_THAT(error("1 0 0 0 0 0 0"), HasSubstr("a.tum:2: qw ''"));
  EXPECT_THAT(error("1 0 0 0 0 0 0 1 5"), HasSubstr("more than the 8 numbers"));
  EXPECT_THAT(error("1 0 0 0 0 0 0 0"), HasSubstr("quaternion of squared length 0"));
  EXPECT_THAT(error_of([&] { read_trajectory_tum(directory_ / "no.tum"); }), HasSubstr("no.tum"));
}

TEST_F(Tum, RefusesToWriteAPoseThatIsNotFinite) {
  const std::vector<topomap::StampedPose> poses{{4, 0, {0.0, std::nan(""), 0.0}}};
  EXPECT_THAT(error_of([&] { write_trajectory_tum(directory_ / "a.tum", poses); }),
              HasSubstr("scan 4 is not finite"));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "a.tum"));
}

}  // namespace
}  // namespace topogeo::storage
