// Error messages for a log, configuration or directory that cannot be used.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class BadInputTest : public testing::Test {
 protected:
  struct Outcome {
    int code;
    std::string err;
  };

  Outcome call(const std::string& command, const std::string& log,
               const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {command, "--log", log, "--out", out_};
    words.insert(words.end(), more.begin(), more.end());
    if (command == "run") words.insert(words.end(), {"--domain", own_domain()});
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    return {code, program.err()};
  }

  /// Expects that the command ends with this code and a one-line error, before it does anything.
  void expect_refused(std::vector<std::string> words, const std::vector<std::string>& more,
                      int code, const std::string& named) {
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--out", out_, "--domain", own_domain()});
    Program program(scratch_, "topogeo", words);
    EXPECT_EQ(program.wait(), code) << named;
    const std::string err = program.err();
    EXPECT_THAT(err, HasSubstr(named));
    EXPECT_EQ(err.find('\n'), err.size() - 1) << err;
    EXPECT_FALSE(std::filesystem::exists(out_)) << "work was begun: " << named;
  }

  std::string file(const std::string& name, const std::string& content) {
    std::ofstream(scratch_ / name, std::ios::binary) << content;
    return scratch_ / name;
  }

  /// Lines of a valid log.
  std::vector<std::string> good_lines() {
    write_log("room", scratch_ / "good.clf");
    std::vector<std::string> lines;
    std::istringstream text(read_file(scratch_ / "good.clf"));
    for (std::string line; std::getline(text, line);) {
      if (line.starts_with("FLASER")) lines.push_back(line);
    }
    return lines;
  }

  static std::string join(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
  }

  Scratch scratch_;
  std::string out_ = scratch_ / "out";
};

/// Replaces the blank-separated word `index` of a line.
std::string with_word(const std::string& line, std::size_t index, const std::string& word) {
  std::istringstream in(line);
  std::string result;
  std::size_t i = 0;
  for (std::string w; in >> w; ++i) result += (i == 0 ? "" : " ") + (i == index ? word : w);
  return result;
}

std::string without_words(const std::string& line, std::size_t first, std::size_t count) {
  std::istringstream in(line);
  std::string result;
  std::size_t i = 0;
  for (std::string w; in >> w; ++i) {
    if (i >= first && i < first + count) continue;
    result += (result.empty() ? "" : " ") + w;
  }
  return result;
}

TEST_F(BadInputTest, UnusableLogsEndWithCodeThreeBeforeAnyWork) {
  const std::vector<std::string> logs = {
      scratch_ / "missing.clf",
      file("empty.clf", ""),
      file("binary.clf", std::string("\x7f"
                                     "ELF\x02\x01\0\0\0\x80\xff\n\0\n",
                                     14)),
      file("no_laser.clf", "# a comment\nPARAM robot_width 0.5\nODOM 0 0 0 0 0 0 1.0 host 1.0\n"),
      file("broken.clf.gz", "\x1f\x8b\x08 and then nothing sensible"),
  };
  for (const char* command : {"map", "run"}) {
    for (const std::string& log : logs) {
      const Outcome outcome = call(command, log);
      EXPECT_EQ(outcome.code, 3) << command << " " << log;
      EXPECT_THAT(outcome.err, HasSubstr(log));
      EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
      EXPECT_FALSE(std::filesystem::exists(out_)) << "work was begun on " << log;
    }
  }
}

TEST_F(BadInputTest, BadLinesAreToldCountedAndLeftOut) {
  std::vector<std::string> lines = good_lines();
  ASSERT_GT(lines.size(), 30U);
  const std::size_t good = lines.size();
  const std::string sample = lines[20];
  // Edited from the back, so that earlier lines keep their numbers; line numbers count from 1.
  lines.insert(lines.begin() + 20, without_words(with_word(sample, 1, "180"), 2, 181));
  lines.insert(lines.begin() + 15, lines[3]);                        // time goes backwards
  lines.insert(lines.begin() + 12, without_words(sample, 100, 50));  // too few ranges
  lines.insert(lines.begin() + 9, with_word(sample, 7, "-1.5"));
  lines.insert(lines.begin() + 6, with_word(sample, 5, "1e99"));
  const std::string log = file("bad.clf", join(lines));

  const Outcome map = call("map", log);
  ASSERT_EQ(map.code, 0) << map.err;
  // The first line for each reason; lines 7 and 15 have the same one.
  for (const int line : {7, 11, 19, 25}) {
    EXPECT_THAT(map.err, HasSubstr("bad.clf:" + std::to_string(line) + ":"));
  }
  EXPECT_THAT(map.err, HasSubstr("skipped 5: 2 bad fields, "));
  const json counts = json::parse(read_file(out_ + "/report.json"))["counts"];
  EXPECT_EQ(counts["scans"], good);
  std::size_t skipped = 0;
  for (const auto& [reason, count] : counts["skipped_lines"].items()) {
    skipped += count.get<std::size_t>();
  }
  EXPECT_EQ(skipped, 5U);
  const std::string trajectory = read_file(out_ + "/trajectory.tum");
  EXPECT_EQ(static_cast<std::size_t>(std::count(trajectory.begin(), trajectory.end(), '\n')), good);

  const Outcome run = call("run", log);
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(json::parse(read_file(out_ + "/report.json"))["counts"], counts);
  EXPECT_TRUE(read_file(out_ + "/trajectory.tum") == trajectory);
}

TEST_F(BadInputTest, TruncatedArchiveIsMappedAsFarAsItGoes) {
  write_log("room", scratch_ / "whole.clf.gz");
  const std::string whole = read_file(scratch_ / "whole.clf.gz");
  const std::string log = file("cut.clf.gz", whole.substr(0, whole.size() / 2));
  const Outcome outcome = call("map", log);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("cut.clf.gz"), HasSubstr("skipped 1")));
  const json counts = json::parse(read_file(out_ + "/report.json"))["counts"];
  EXPECT_GT(counts["scans"], 10);
  EXPECT_EQ(counts["skipped_lines"].size(), 1U);
}

TEST_F(BadInputTest, UnwritableDirectoryIsToldBeforeTheWork) {
  write_log("room", scratch_ / "log.clf");
  out_ = file("file", "in the way") + "/out";  // root may write anywhere, but not below a file
  for (const char* command : {"map", "run"}) {
    const Outcome outcome = call(command, scratch_ / "log.clf");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(out_), Not(HasSubstr("scans"))));
  }
}

TEST_F(BadInputTest, AFolderWithTheDatabaseOfAnotherRunIsNotMixedWithItsResults) {
  good_lines();
  std::filesystem::create_directories(out_);
  const std::string database = std::filesystem::path(out_) / "map.sqlite";
  std::ofstream(database) << "a map";
  const Outcome outcome = call("map", scratch_ / "good.clf");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("map.sqlite' is the map of another run"));
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(out_) / "map.pb"));
}

TEST_F(BadInputTest, ConfigurationFaultsNameTheLine) {
  write_log("room", scratch_ / "log.clf");
  const std::string unknown = file("unknown.yaml", "stop:\n  distance_m: 1\n  distanze_m: 1\n");
  const std::string range = file("range.yaml", "stop:\n  distance_m: 99\n");
  for (const char* command : {"map", "run"}) {
    const Outcome of_key = call(command, scratch_ / "log.clf", {"--config", unknown});
    EXPECT_EQ(of_key.code, 2);
    EXPECT_THAT(of_key.err, AllOf(HasSubstr(unknown + ":3:"), HasSubstr("stop.distanze_m")));
    const Outcome of_value = call(command, scratch_ / "log.clf", {"--config", range});
    EXPECT_EQ(of_value.code, 2);
    EXPECT_THAT(of_value.err, AllOf(HasSubstr(range + ":2:"), HasSubstr("between 0.1 and 10 m")));
    EXPECT_FALSE(std::filesystem::exists(out_));
  }
}

TEST_F(BadInputTest, AReferenceWithOtherTimesIsNamedAfterMapping) {
  static_cast<void>(good_lines());
  const std::string reference =
      file("other.tum", "90000 0 0 0 0 0 0 1\n90001 1 0 0 0 0 0 1\n90002 2 0 0 0 0 0 1\n");
  const Outcome outcome = call("map", scratch_ / "good.clf", {"--reference", reference});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("the results are written, but " + reference + " cannot be compared"),
                    HasSubstr("--max-dt SECONDS")));
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out_) / "map.pb"));
}

// The mirror image would be mapped as well as the room.
TEST_F(BadInputTest, ScansThatAreMirroredAgainstTheOdometryAreRefused) {
  write_log("floor", scratch_ / "floor.clf");
  scan::CarmenLogReader reader(scratch_ / "floor.clf");
  scan::CarmenLogWriter writer(scratch_ / "mirrored.clf");
  while (std::optional<scan::Scan> scan = reader.next()) {
    std::ranges::reverse(scan->ranges_m);
    writer.write(*scan);
  }
  writer.close();
  const Outcome outcome = call("map", scratch_ / "mirrored.clf");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("the scans are mirrored against the odometry"),
                                 HasSubstr("expected --upside-down")));
  EXPECT_EQ(call("map", scratch_ / "mirrored.clf", {"--upside-down"}).code, 0);
}

// Nothing starts when inputs cannot be used, whatever the source of scans.
TEST_F(BadInputTest, RunsOnDevicesCheckTheirInputsBeforeAnythingStarts) {
  const std::string world = std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml";
  const std::string devices = file("robot.yaml", "laser.port: /dev/laser\n");
  const std::string text = file("text", "neither map nor trajectory\n");
  struct Case {
    std::vector<std::string> more;
    int code;
    std::string named;
  };
  const std::vector<Case> cases = {
      {{"--config", file("range.yaml", "stop:\n  distance_m: 99\n")}, 2, "range.yaml:2:"},
      {{"--reference", scratch_ / "none.tum"}, 3, "none.tum"},
      {{"--map", text}, 3, text},
      {{"--continue", text}, 3, text},
      {{"--initial-pose", "1,2,90"}, 2, "--initial-pose"},
  };
  for (const std::vector<std::string>& source :
       {std::vector<std::string>{"run", "--sim", world}, {"run", "--devices", devices}}) {
    for (const Case& bad : cases) expect_refused(source, bad.more, bad.code, bad.named);
  }
  const Case& configuration = cases.front();
  expect_refused({"demo", "--sim"}, configuration.more, configuration.code, configuration.named);
}

TEST_F(BadInputTest, DevicesThatARunCannotUseAreNamedBeforeAnythingStarts) {
  const auto run = [this](const std::string& devices, const std::vector<std::string>& more,
                          const std::string& named) {
    expect_refused({"run", "--devices", devices}, more, 2, named);
  };
  run(scratch_ / "none.yaml", {}, "none.yaml");
  run(file("key.yaml", "laser:\n  port: /dev/laser\n  bauds: 9600\n"), {}, "key.yaml:3:");
  run(file("blind.yaml", "base.port: /dev/base\n"), {}, "'laser.port'");
  run(file("still.yaml", "laser.port: /dev/laser\n"), {"--explore"}, "'base.port'");
}

TEST_F(BadInputTest, AWorldWhoseTourBeginsInAWallIsNamedBeforeAnythingStarts) {
  const std::string world = file("wall.yaml",
                                 "name: wall\nwalls: [{from: [0, 0], to: [8, 0]}]\n"
                                 "tour: [[1, 0.1], [6, 0.1]]\n");
  expect_refused({"run", "--sim", world}, {}, 3, world + ": wall: the robot overlaps");
}

}  // namespace
}  // namespace topogeo::test
