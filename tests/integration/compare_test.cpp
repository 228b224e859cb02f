// topogeo compare: its results on paths worked by hand, as text and JSON, and its errors.
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_test.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

// Three steps of 1 m along x, a second each; the estimate begins elsewhere, faces left, and its
// last step is 1.3 m long.
constexpr const char* kReference =
    "# t x y z qx qy qz qw\n"
    "10.0 0 0 0 0 0 0 1\n11.0 1 0 0 0 0 0 1\n12.0 2 0 0 0 0 0 1\n13.0 3 0 0 0 0 0 1\n";
constexpr const char* kEstimate =
    "10.0 5 5 0 0 0 0.707106781 0.707106781\n11.0 5 6 0 0 0 0.707106781 0.707106781\n"
    "12.01 5 7 0 0 0 0.707106781 0.707106781\n13.0 5 8.3 0 0 0 0.707106781 0.707106781\n";
constexpr const char* kRelations = "10 11 1.1 0 0 0 0 0.1\n10 60 9 0 0 0 0 0\n";

class CompareTest : public CommandTest {
 protected:
  CompareTest()
      : CommandTest("compare"),
        estimate_(scratch_ / "estimate.tum"),
        reference_(scratch_ / "reference.tum") {
    std::ofstream(estimate_) << kEstimate;
    std::ofstream(reference_) << kReference;
    std::ofstream(relations_) << kRelations;
  }

  std::filesystem::path estimate_;
  std::filesystem::path reference_;
  std::filesystem::path relations_ = scratch_ / "relations";
};

TEST_F(CompareTest, PrintsTheFiguresOfTheEvaluationTool) {
  // Along the line the aligned errors are those about their mean: positions 0, 1, 2, 3.3 less 0, 1,
  // 2, 3 less the mean 0.075: rms sqrt((3 * 0.075^2 + 0.225^2) / 4) = 0.1299.
  ASSERT_EQ(run({estimate_, reference_}), 0) << err_;
  EXPECT_EQ(out_,
            "matched 1.000  path 3 m\n"
            "ate     0.130 m\n"
            "local   0.100 m 0.00 deg over 3 pairs\n"
            "loop    none\n"
            "end     0.300 m\n");
  ASSERT_EQ(run({estimate_, reference_, "--relations", relations_}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("relations (2 in the file)\n"
                              "  all   0.1000 +- 0.0000 m  5.730 +- 0.000 deg over 1 pairs\n"
                              "  far   none\n"));
}

TEST_F(CompareTest, JsonHasTheSameFiguresUnrounded) {
  ASSERT_EQ(run({estimate_, reference_, "--relations", relations_, "--json"}), 0) << err_;
  const json figures = json::parse(out_);
  EXPECT_EQ(figures["matched"], 1.0);
  EXPECT_NEAR(figures["ate"], 0.12990381, 1e-8);
  EXPECT_NEAR(figures["local"]["m"], 0.1, 1e-8);
  EXPECT_EQ(figures["local"]["pairs"], 3);
  EXPECT_TRUE(figures["loop"].is_null());
  EXPECT_NEAR(figures["end"], 0.3, 1e-8);
  EXPECT_EQ(figures["path"], 3.0);
  EXPECT_EQ(figures["relations"]["in_file"], 2);
  EXPECT_NEAR(figures["relations"]["all"]["m"], 0.1, 1e-8);
  EXPECT_NEAR(figures["relations"]["all"]["deg"], 5.7295780, 1e-6);
  EXPECT_TRUE(figures["relations"]["far"].is_null());
}

TEST_F(CompareTest, TheLargestTimeApartCanBeSet) {
  // Without the pose that is 10 ms late, three remain.
  ASSERT_EQ(run({estimate_, reference_, "--max-dt", "0.001"}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("matched 0.750"));
  EXPECT_EQ(run({estimate_, reference_, "--max-dt", "-1"}), 2);
}

TEST_F(CompareTest, AConfigurationMovesTheEstimateToTheLaser) {
  // The robot turns about its own origin; the laser, 0.4 m in front of it, moves on a circle.
  std::ofstream(estimate_) << "10 0 0 0 0 0 0 1\n11 0 0 0 0 0 0.707106781 0.707106781\n"
                              "12 0 0 0 0 0 1 0\n";
  std::ofstream(reference_) << "10 0.4 0 0 0 0 0 1\n11 0 0.4 0 0 0 0.707106781 0.707106781\n"
                               "12 -0.4 0 0 0 0 1 0\n";
  std::ofstream(scratch_ / "laser.yaml") << "laser: {x_m: 0.4}\n";
  ASSERT_EQ(run({estimate_, reference_}), 0) << err_;
  EXPECT_THAT(out_, testing::Not(HasSubstr("ate     0.000 m")));
  ASSERT_EQ(run({estimate_, reference_, "--config", scratch_ / "laser.yaml"}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("ate     0.000 m"));
  EXPECT_THAT(out_, HasSubstr("end     0.000 m"));
  std::ofstream(scratch_ / "laser.yaml") << "laser: {x_m: 40}\n";
  EXPECT_EQ(run({estimate_, reference_, "--config", scratch_ / "laser.yaml"}), 2);
}

TEST_F(CompareTest, UnusableFilesAreToldWithTheirLine) {
  const auto refused = [&](const std::vector<std::string>& words, const std::string& message) {
    EXPECT_EQ(run(words), 3) << out_;
    EXPECT_THAT(err_, StartsWith("topogeo: "));
    EXPECT_THAT(err_, HasSubstr(message));
    EXPECT_EQ(err_.find('\n'), err_.size() - 1) << err_;
    EXPECT_EQ(out_, "");
  };
  const std::filesystem::path bad = scratch_ / "bad";
  refused({scratch_ / "none.tum", reference_}, "none.tum: cannot be opened");
  refused({estimate_, scratch_ / "none.tum"}, "none.tum: cannot be opened");
  refused({estimate_, reference_, "--relations", scratch_ / "none"}, "none: cannot be opened");
  std::ofstream(bad) << "1 0 0 0 0 0 0 1\n\n2 x 0 0 0 0 0 1\n";
  refused({estimate_, bad}, "bad:3: x 'x'");
  std::ofstream(bad) << "# nothing\n";
  refused({bad, reference_}, "bad: has no poses");
  refused({estimate_, reference_, "--relations", bad}, "bad: has no relations");
  std::ofstream(bad) << "1 2 0 0 0 0 0\n";
  refused({estimate_, reference_, "--relations", bad}, "bad:1: yaw ''");
  std::ofstream(bad) << "900 0 0 0 0 0 0 1\n901 0 0 0 0 0 0 1\n902 0 0 0 0 0 0 1\n";
  refused({bad, reference_}, "reference.tum: only 0 poses match in time (within 0.05 s), expected");
  EXPECT_THAT(err_, HasSubstr("the estimate covers 900.000 to 902.000 s"));
  EXPECT_EQ(run({estimate_}), 2);
}

TEST_F(CompareTest, LoopsOfAMapAreCountedFromItsReport) {
  const std::string log = scratch_ / "log.clf.gz";
  const std::string truth = scratch_ / "truth.tum";
  const std::filesystem::path out = scratch_ / "out";
  write_log("floor", log, truth);
  Program map(scratch_, "topogeo", {"map", "--log", log, "--out", out});
  ASSERT_EQ(map.wait(), 0) << map.err();

  ASSERT_EQ(run({out / "map.pb", truth, "--loops", "--json"}), 0) << err_;
  const json loops = json::parse(out_);
  EXPECT_GT(loops["revisits"], 0);
  EXPECT_GT(loops["tried"], 0);
  EXPECT_LE(loops["tried"], loops["revisits"]);
  EXPECT_GT(loops["accepted"], 0);
  EXPECT_LE(loops["accepted"], loops["tried"]);
  EXPECT_EQ(loops["wrong"], 0);
  EXPECT_TRUE(loops["rejected"].is_object());
  const json& tenths = loops["reliability"]["tenths"];
  ASSERT_EQ(tenths.size(), 10U);
  EXPECT_GT(tenths[9]["decisions"], 0);
  EXPECT_GT(tenths[9]["stated"], 0.9);
  EXPECT_LE(tenths[9]["right"], tenths[9]["decisions"]);
  EXPECT_LT(loops["reliability"]["brier_score"], 0.1);

  std::filesystem::rename(out / "report.json", scratch_ / "other.json");
  EXPECT_EQ(run({out / "map.pb", truth, "--loops"}), 3);
  EXPECT_THAT(err_, HasSubstr("report.json: does not exist"));
  ASSERT_EQ(run({out / "map.pb", truth, "--loops", "--report", scratch_ / "other.json"}), 0)
      << err_;
  EXPECT_THAT(out_, HasSubstr("accepted  " + loops["accepted"].dump() + "\n"));
  EXPECT_THAT(out_, HasSubstr("prediction  accepted "));
  EXPECT_THAT(out_, HasSubstr("\n0.9 to 1.0 "));
}

TEST_F(CompareTest, AMapIsComparedByItsLoopsAlone) {
  EXPECT_EQ(run({"map.pb", reference_}), 2);
  EXPECT_THAT(err_, HasSubstr("map.pb is a map, expected a trajectory (TUM)"));
  EXPECT_EQ(run({estimate_, reference_, "--report", "report.json"}), 2);
  EXPECT_EQ(run({"map.pb", reference_, "--loops", "--relations", relations_}), 2);
  EXPECT_EQ(run({estimate_, reference_, "--loops"}), 3);
  EXPECT_THAT(err_, HasSubstr("estimate.tum: "));
}

TEST_F(CompareTest, AgreesWithTheFiguresOfMapWithAReference) {
  const std::string log = scratch_ / "log.clf.gz";
  const std::string truth = scratch_ / "truth.tum";
  write_log("ring", log, truth);
  Program map(scratch_, "topogeo",
              {"map", "--log", log, "--out", scratch_ / "out", "--reference", truth});
  ASSERT_EQ(map.wait(), 0) << map.err();
  for (const auto& [name, file] :
       {std::pair{"odometry", "odometry.tum"}, std::pair{"corrected", "trajectory.tum"}}) {
    ASSERT_EQ(run({scratch_ / "out" / file, truth}), 0) << err_;
    const std::string ate = out_.substr(out_.find("ate     ") + 8, 5);
    const std::string line = map.out().substr(map.out().find(std::string("  ") + name));
    EXPECT_THAT(line.substr(0, line.find('\n')), HasSubstr(ate + " m rms"));
  }
}

}  // namespace
}  // namespace topogeo::test
