// topogeo dvl: pictures of one scan and of a log, and its errors for bad input.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class DvlTest : public testing::Test {
 protected:
  DvlTest() : log_(scratch_ / "log.clf.gz") { write_log("room", log_); }

  /// Exit code of `topogeo dvl --log LOG WORDS...`; its stderr is in `err_`.
  int dvl(std::vector<std::string> words) {
    words.insert(words.begin(), {"dvl", "--log", log_});
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    err_ = program.err();
    return code;
  }

  Scratch scratch_;
  std::string log_;
  std::string err_;
};

TEST_F(DvlTest, HasHelp) {
  Program help(scratch_, "topogeo", {"dvl", "--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_THAT(help.out(), HasSubstr("Usage: topogeo dvl"));
  EXPECT_THAT(help.out(), HasSubstr("--scan"));
}

TEST_F(DvlTest, DrawsOneScanAsPngAndSvg) {
  const std::string png = scratch_ / "scan.png";
  const std::string svg = scratch_ / "scan.svg";
  ASSERT_EQ(dvl({"--scan", "0", "--out", png}), 0) << err_;
  EXPECT_EQ(err_, "");
  EXPECT_THAT(read_file(png), StartsWith("\x89PNG"));
  ASSERT_EQ(dvl({"--scan", "0", "--out", svg}), 0) << err_;
  const std::string first = read_file(svg);
  EXPECT_THAT(first, StartsWith("<?xml"));
  ASSERT_EQ(dvl({"--scan", "0", "--out", svg}), 0) << err_;
  EXPECT_TRUE(read_file(svg) == first);
  ASSERT_EQ(dvl({"--scan", "5", "--out", svg}), 0) << err_;
  EXPECT_FALSE(read_file(svg) == first);
}

TEST_F(DvlTest, DrawsAContactSheet) {
  const std::string few = scratch_ / "few.svg";
  const std::string many = scratch_ / "many.svg";
  const std::string every = scratch_ / "every.svg";
  ASSERT_EQ(dvl({"--all", "--count", "4", "--out", few}), 0) << err_;
  ASSERT_EQ(dvl({"--all", "--out", many}), 0) << err_;
  ASSERT_EQ(dvl({"--all", "--every", "2", "--out", every}), 0) << err_;
  EXPECT_THAT(read_file(few), StartsWith("<?xml"));
  EXPECT_GT(std::filesystem::file_size(many), 2 * std::filesystem::file_size(few));
  EXPECT_GT(std::filesystem::file_size(every), 2 * std::filesystem::file_size(few));
}

TEST_F(DvlTest, TakesTheConfiguration) {
  const std::string config = scratch_ / "near.yaml";
  std::ofstream(config) << "local_map:\n  range_limit_m: 1.5\n";
  const std::string with = scratch_ / "with.svg";
  const std::string without = scratch_ / "without.svg";
  ASSERT_EQ(dvl({"--scan", "3", "--config", config, "--out", with}), 0) << err_;
  ASSERT_EQ(dvl({"--scan", "3", "--out", without}), 0) << err_;
  EXPECT_FALSE(read_file(with) == read_file(without));
  std::ofstream(config) << "local_map:\n  range_limit_m: -1\n";
  EXPECT_EQ(dvl({"--scan", "3", "--config", config, "--out", with}), 2);
  EXPECT_THAT(err_, HasSubstr("local_map.range_limit_m"));
}

TEST_F(DvlTest, AScanBeyondTheLogTellsHowManyThereAre) {
  EXPECT_EQ(dvl({"--scan", "100000", "--out", scratch_ / "x.png"}), 2);
  EXPECT_THAT(err_, testing::ContainsRegex("--scan 100000: .*log.clf.gz has [0-9]+ usable scans, "
                                           "0 to [0-9]+"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "x.png"));
}

TEST_F(DvlTest, CountsUsableScansAndTellsOfSkippedLines) {
  const std::string whole = scratch_ / "whole.svg";
  const std::string spoiled = scratch_ / "spoiled.svg";
  const std::string log = scratch_ / "plain" / "log.clf";
  std::filesystem::create_directory(scratch_ / "plain");
  write_log("room", log);
  log_ = log;
  ASSERT_EQ(dvl({"--scan", "2", "--out", whole}), 0) << err_;
  const std::string content = read_file(log);
  std::ofstream(log) << "FLASER 3 1.0 two 3.0\n" << content;
  ASSERT_EQ(dvl({"--scan", "2", "--out", spoiled}), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("log.clf:1: expected"));
  EXPECT_TRUE(read_file(spoiled) == read_file(whole));
}

TEST_F(DvlTest, WrongCommandLinesAreToldInOneLine) {
  const std::string out = scratch_ / "x.png";
  const std::vector<std::vector<std::string>> lines = {
      {"--out", out},
      {"--scan", "1"},
      {"--scan", "-1", "--out", out},
      {"--scan", "1", "--out", scratch_ / "x.jpg"},
      {"--scan", "1", "--all", "--out", out},
      {"--scan", "1", "--count", "3", "--out", out},
      {"--all", "--count", "0", "--out", out},
      {"--all", "--count", "601", "--out", out},
      {"--all", "--every", "0", "--out", out},
      {"--all", "--every", "2", "--count", "3", "--out", out},
      {"--scan", "1", "--width", "10", "--out", out},
      {"--scan", "1", "--config", scratch_ / "none.yaml", "--out", out},
  };
  for (const auto& line : lines) {
    EXPECT_EQ(dvl(line), 2) << testing::PrintToString(line);
    EXPECT_THAT(err_, StartsWith("topogeo: ")) << testing::PrintToString(line);
    EXPECT_EQ(err_.find('\n'), err_.size() - 1) << err_;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(DvlTest, UnusableLogsAndDirectoriesAreNamed) {
  log_ = scratch_ / "none.clf";
  EXPECT_EQ(dvl({"--scan", "0", "--out", scratch_ / "x.png"}), 3);
  EXPECT_THAT(err_, HasSubstr("none.clf"));
  std::ofstream(log_) << "no laser lines here\n";
  EXPECT_EQ(dvl({"--all", "--out", scratch_ / "x.png"}), 3);
  EXPECT_THAT(err_, HasSubstr("none.clf"));
  log_ = scratch_ / "log.clf.gz";
  EXPECT_EQ(dvl({"--scan", "0", "--out", scratch_ / "no" / "x.png"}), 1);
  EXPECT_THAT(err_, HasSubstr("x.png"));
}

}  // namespace
}  // namespace topogeo::test
