// topogeo match: text, JSON, picture and one-line errors.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_test.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class MatchTest : public CommandTest {
 protected:
  MatchTest() : CommandTest("match"), log_(scratch_ / "log.clf.gz") { write_log("room", log_); }

  std::string log_;
};

TEST_F(MatchTest, ShowsTheSearchOfALogAndOfItsMap) {
  const std::string picture = scratch_ / "match.png";
  ASSERT_EQ(run({log_, "--stops", "1,3", "--out", picture}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("predicted: x "));
  EXPECT_THAT(out_, HasSubstr("solution 1: "));
  EXPECT_THAT(out_, HasSubstr("verdict: accepted"));
  EXPECT_THAT(read_file(picture), StartsWith("\x89PNG"));

  Program map(scratch_, "topogeo", {"map", "--log", log_, "--out", scratch_ / "map"});
  ASSERT_EQ(map.wait(), 0) << map.err();
  ASSERT_EQ(run({log_, "--stops", "1,3", "--json"}), 0) << err_;
  const auto of_log = nlohmann::json::parse(out_);
  ASSERT_EQ(run({scratch_ / "map" / "map.pb", "--stops", "1,3", "--json"}), 0) << err_;
  EXPECT_EQ(nlohmann::json::parse(out_), of_log) << "the same stops, the same search";
  ASSERT_EQ(run({scratch_ / "map" / "map.pb", "--stops", "1,3", "--json", "--prediction", "map",
                 "--solutions", "2"}),
            0)
      << err_;
  const auto of_map = nlohmann::json::parse(out_);
  EXPECT_LE(of_map["solutions"].size(), 2U);
  EXPECT_NEAR(of_map["refined"]["T_reference_query"]["x_m"].get<double>(),
              of_log["refined"]["T_reference_query"]["x_m"].get<double>(), 0.05);
}

TEST_F(MatchTest, WrongStopsFilesAndNamesAreOneLineErrors) {
  EXPECT_EQ(run({log_, "--stops", "1"}), 2);
  EXPECT_THAT(err_, HasSubstr("expected two numbers, like 12,80"));
  EXPECT_EQ(run({log_, "--stops", "1,9999"}), 2);
  EXPECT_THAT(err_, HasSubstr("stop 9999 does not exist"));
  EXPECT_EQ(run({log_, "--stops", "2,2"}), 2);
  EXPECT_THAT(err_, HasSubstr("a stop cannot be matched with itself"));
  EXPECT_EQ(run({log_, "--stops", "1,3", "--out", scratch_ / "match.gif"}), 2);
  EXPECT_THAT(err_, HasSubstr(".png or .svg"));
  EXPECT_EQ(run({log_, "--stops", "1,3", "--prediction", "map"}), 2);
  EXPECT_THAT(err_, HasSubstr("it is not known where the stops are"));
  EXPECT_EQ(run({scratch_ / "none.pb", "--stops", "1,3"}), 3);
  EXPECT_THAT(err_, HasSubstr("none.pb"));
}

}  // namespace
}  // namespace topogeo::test
