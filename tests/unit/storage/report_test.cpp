#include "topogeo/storage/report.hpp"

#include <gmock/gmock.h>

#include "topogeo/support/version.hpp"

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using ReportFile = ScratchDirectory;

TEST_F(ReportFile, SaysWhatWasDoneInAFixedOrder) {
  Report report;
  report.command = "map";
  report.log = "/home/somebody/logs/csail.clf.gz";
  report.robot_id = "robot-1";
  report.seed = 18446744073709551615ULL;
  report.workers = 2;
  report.configuration.values = {{"mapping.stop_distance_m", "1"}, {"a.later", "x \"y\""}};
  report.configuration.fingerprint = 0xabcULL;
  report.scans = 1223;
  report.skipped_lines = {{"NaN range", 2}, {"beam count", 0}};
  report.loop_closures = {{3, 40, {0.5, -0.25, 1.5}}};
  report.distance_m = 383.25;
  report.stages = {{"tracking", 1.5, 1.25}};
  const std::string json = report_json(report);

  EXPECT_THAT(json, HasSubstr("\"version\": \"" + std::string(support::kVersion) + "\""));
  EXPECT_THAT(json, HasSubstr("\"log\": \"csail.clf.gz\""));
  EXPECT_THAT(json, Not(HasSubstr("somebody")));
  EXPECT_THAT(json, HasSubstr("\"seed\": 18446744073709551615"));
  EXPECT_THAT(json, HasSubstr("\"fingerprint\": \"0000000000000abc\""));
  EXPECT_THAT(json, HasSubstr("\"a.later\": \"x \\\"y\\\"\""));
  EXPECT_LT(json.find("mapping.stop_distance_m"), json.find("a.later"));
  EXPECT_THAT(json, HasSubstr("\"NaN range\": 2"));
  EXPECT_THAT(json, HasSubstr("\"earlier_stop\": 3"));
  EXPECT_THAT(json, HasSubstr("\"distance_m\": 383.25"));
  EXPECT_EQ(json.back(), '\n');

  write_report(directory_ / "report.json", report);
  EXPECT_EQ(content(directory_ / "report.json"), json);
}

TEST_F(ReportFile, LoopCandidatesReadBackExactly) {
  Report report;
  const LoopCandidate candidate{40,
                                3,
                                40,
                                "match not accepted",
                                "few inliers",
                                {0.1, -0.2, 0.3},
                                0.4,
                                0.5,
                                0.6,
                                "window",
                                {0.7, -0.8, 0.9},
                                1.25,
                                0.125};
  report.loop_candidates = {candidate, candidate};
  report.loop_candidates[1].source = "place";
  report.loop_candidates[1].probability = 0.75;
  EXPECT_THAT(report_json(report), HasSubstr("\"predicted_sigma_m\": 1.25"));
  write_report(directory_ / "report.json", report);
  const auto back = read_loop_candidates(directory_ / "report.json");
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0], candidate);
  EXPECT_EQ(back[1], report.loop_candidates[1]);
}

TEST_F(ReportFile, HoldsOverlapsWhereThereAreAny) {
  Report report;
  EXPECT_THAT(report_json(report), Not(HasSubstr("overlaps")));
  OverlapSearch found;
  found.earlier_id = 3;
  found.T_predicted = {0.5, -0.25, 1.5};
  found.solutions = {{{0.75, -0.5, 1.25}, 0.5, 0.25, 0.125, 0.0625}};
  found.verdict = "rejected";
  found.reason = "few inliers";
  report.overlaps = {{7, {2, 3, 5}, {found}}};
  std::string json = report_json(report);
  std::erase_if(json, [](char c) { return c == ' ' || c == '\n'; });
  EXPECT_THAT(json, HasSubstr(R"("overlaps":[{"stop":7,"overlap_set":[2,3,5],"searches":[{)"));
  EXPECT_THAT(json, HasSubstr(R"("earlier_stop":3,"predicted_x_m":0.5,"predicted_y_m":-0.25,)"));
  EXPECT_THAT(json, HasSubstr(R"("solutions":[{"x_m":0.75,"y_m":-0.5,"theta_rad":1.25,)"
                              R"("fitness":0.5,"scan_fitness":0.25,"topological_fitness":0.125,)"
                              R"("prior":0.0625}])"));
  EXPECT_THAT(json, HasSubstr(R"("refined":null,"verdict":"rejected","reason":"fewinliers")"));
  report.overlaps.front().searches.front().refined = found.solutions.front();
  EXPECT_THAT(report_json(report), Not(HasSubstr("null")));
}

TEST_F(ReportFile, DamagedLoopCandidatesAreRefusedWithTheirPlace) {
  const auto path = directory_ / "report.json";
  const auto read = [&] { read_loop_candidates(path); };
  EXPECT_THAT(error_of(read), HasSubstr("report.json: cannot be opened"));
  std::ofstream(path) << "{";
  EXPECT_THAT(error_of(read), HasSubstr("report.json: the report: "));
  std::ofstream(path) << R"({"loop_candidates": [{"decided_at_stop": 3}]})";
  EXPECT_THAT(error_of(read), HasSubstr("report.json: loop_candidates[0]: "));
  EXPECT_THAT(error_of(read), HasSubstr("'earlier_stop' not found"));
}

TEST_F(ReportFile, TakesNamesThatAreNotUtf8AndRefusesAnImpossiblePath) {
  Report report;
  report.log = "caf\xe9.log";
  EXPECT_THAT(report_json(report), HasSubstr("caf\xef\xbf\xbd.log"));
  EXPECT_THAT(error_of([&] { write_report(directory_ / "no" / "report.json", report); }),
              HasSubstr("report.json: cannot be created"));
}

}  // namespace
}  // namespace topogeo::storage
