// Localizing in a stored map: the same over DDS as in one process, commands to a running localizer,
// and maps that cannot be used.
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class LocalizeTest : public testing::Test {
 protected:
  void make_map() {
    write_log("ring", log_);
    Program program(scratch_, "topogeo", {"map", "--log", log_, "--out", scratch_ / "map"});
    ASSERT_EQ(program.wait(), 0) << program.err();
  }

  Scratch scratch_;
  std::string log_ = scratch_ / "log.clf.gz";
  std::string map_ = scratch_ / "map" / "map.pb";
};

class LocalizeByWorkersTest : public LocalizeTest, public testing::WithParamInterface<int> {};

TEST_P(LocalizeByWorkersTest, OverDdsItGivesTheBytesOfOneProcessAndLeavesTheMapAlone) {
  make_map();
  const std::string before = read_file(map_);
  Program alone(scratch_, "topogeo",
                {"localize", "--log", log_, "--map", map_, "--out", scratch_ / "alone"});
  ASSERT_EQ(alone.wait(), 0) << alone.err();
  EXPECT_THAT(alone.out(), HasSubstr("localization: "));
  Program run(scratch_, "topogeo",
              {"run", "--log", log_, "--map", map_, "--out", scratch_ / "run", "--workers",
               std::to_string(GetParam()), "--domain", own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  for (const char* file : {"localization.csv", "trajectory.tum", "map.pb"}) {
    EXPECT_TRUE(read_file(scratch_ / "run" / file) == read_file(scratch_ / "alone" / file)) << file;
  }
  EXPECT_TRUE(read_file(map_) == before);
  const json report = json::parse(read_file(scratch_ / "alone" / "report.json"));
  const json over_dds = json::parse(read_file(scratch_ / "run" / "report.json"));
  EXPECT_EQ(report["localization"], over_dds["localization"]);
  EXPECT_GT(report["localization"]["TRACKING"].get<int>(),
            report["counts"]["stops"].get<int>() / 2);
}

INSTANTIATE_TEST_SUITE_P(Workers, LocalizeByWorkersTest, testing::Values(1, 2, 4),
                         [](const auto& workers) { return std::to_string(workers.param); });

TEST_F(LocalizeTest, AGridGetsStops) {
  write_log("ring", log_);
  const std::string plan = scratch_ / "plan.pb";
  const std::string world = std::string(TOPOGEO_SHARE) + "/worlds/ring.world.yaml";
  Program import(scratch_, "topogeo",
                 {"store", "import", world, "--format", "drawing", "--out", plan});
  ASSERT_EQ(import.wait(), 0) << import.err();
  Program grid(scratch_, "topogeo",
               {"store", "export", plan, "--format", "pgm", "--out", scratch_ / "grid"});
  ASSERT_EQ(grid.wait(), 0) << grid.err();
  for (const std::string& map : {plan, std::string(scratch_ / "grid.yaml")}) {
    Program localize(scratch_, "topogeo",
                     {"localize", "--log", log_, "--map", map, "--out", scratch_ / "out"});
    ASSERT_EQ(localize.wait(), 0) << localize.err();
    EXPECT_THAT(localize.err(), HasSubstr("stops are made of it"));
    const json report = json::parse(read_file(scratch_ / "out" / "report.json"));
    EXPECT_GT(report["localization"]["TRACKING"].get<int>(),
              report["counts"]["stops"].get<int>() / 2)
        << map;
  }
}

TEST_F(LocalizeTest, CommandsAreAcceptedOrRefusedWithTheReason) {
  make_map();
  const std::string domain = own_domain();
  Program localizer(scratch_, "localizer", {"--domain", domain, "--map", map_});
  const auto ask = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "localizer");
    words.insert(words.end(), {"--domain", domain, "--wait-seconds", "600"});
    return words;
  };
  Program set_pose(scratch_, "topogeo", ask({"set-pose", "1.5,0,90"}));
  EXPECT_EQ(set_pose.wait(), 0) << set_pose.err();
  EXPECT_THAT(set_pose.out(), HasSubstr("accepted: localization continues from this pose"));
  Program search(scratch_, "topogeo", ask({"search"}));
  EXPECT_EQ(search.wait(), 0) << search.err();
  Program mapping(scratch_, "topogeo", ask({"mode", "mapping"}));
  EXPECT_EQ(mapping.wait(), 1);
  EXPECT_THAT(mapping.err(), HasSubstr("refused: --map gives a read-only map"));
}

TEST_F(LocalizeTest, AWrongFileAPoseThatIsNoneAndNobodyThereAreOneLineErrors) {
  write_log("room", log_);
  std::ofstream(scratch_ / "no.pb") << "this is no map";
  Program wrong(scratch_, "topogeo",
                {"localize", "--log", log_, "--map", scratch_ / "no.pb", "--out", scratch_ / "o"});
  EXPECT_EQ(wrong.wait(), 3);
  EXPECT_THAT(wrong.err(), HasSubstr("no.pb"));
  Program service(scratch_, "localizer", {"--domain", own_domain(), "--map", scratch_ / "no.pb"});
  EXPECT_EQ(service.wait(), 3);
  EXPECT_THAT(service.err(), HasSubstr("no.pb"));
  Program pose(scratch_, "topogeo", {"localizer", "set-pose", "1,two,3"});
  EXPECT_EQ(pose.wait(), 2);
  EXPECT_THAT(pose.err(), HasSubstr("expected x,y,degrees"));
  Program nobody(scratch_, "topogeo",
                 {"localizer", "search", "--domain", own_domain(), "--wait-seconds", "0.5"});
  EXPECT_EQ(nobody.wait(), 1);
  EXPECT_THAT(nobody.err(), HasSubstr("no localizer is alive"));
}

}  // namespace
}  // namespace topogeo::test
