// topogeo store: contents of maps, and maps in the formats of other programs.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct StoreOutcome {
  int code = 0;
  std::string out;
  std::string err;
};

class StoreTest : public testing::Test {
 protected:
  void SetUp() override {
    write_log("room", scratch_ / "room.clf");
    ASSERT_EQ(call({"map", "--log", scratch_ / "room.clf", "--out", scratch_ / "out"}).code, 0);
    map_ = scratch_ / "out/map.pb";
  }

  StoreOutcome call(const std::vector<std::string>& words) {
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    return {code, program.out(), program.err()};
  }
  StoreOutcome store(std::vector<std::string> words) {
    words.insert(words.begin(), "store");
    return call(words);
  }
  std::string path(const std::string& name) const { return (scratch_ / name).string(); }

  Scratch scratch_;
  std::string map_;
};

TEST_F(StoreTest, InfoCheckAndListAgreeOnAMap) {
  const StoreOutcome info = store({"info", map_, "--json"});
  ASSERT_EQ(info.code, 0) << info.err;
  const auto read = nlohmann::json::parse(info.out);
  EXPECT_GT(read.at("stops"), 5);
  EXPECT_EQ(read.at("sessions"), 1);
  EXPECT_EQ(read.at("file_bytes"), std::filesystem::file_size(map_));
  EXPECT_THAT(store({"info", map_}).out, HasSubstr("in 1 session"));
  const StoreOutcome check = store({"check", map_});
  EXPECT_EQ(check.code, 0) << check.out;
  EXPECT_THAT(check.out, HasSubstr("no fault found"));
  EXPECT_THAT(store({"list", path("")}).out, HasSubstr("out/map.pb"));

  const auto checked = nlohmann::json::parse(store({"check", map_, "--json"}).out);
  EXPECT_EQ(checked.at("file"), map_);
  EXPECT_EQ(checked.at("good"), true);
  EXPECT_THAT(checked.at("contradictions"), IsEmpty());
  const auto list = nlohmann::json::parse(store({"list", path(""), "--json"}).out);
  const auto found = std::find_if(list.begin(), list.end(), [](const nlohmann::json& map) {
    return map.at("file") == "out/map.pb";
  });
  ASSERT_NE(found, list.end()) << list;
  EXPECT_EQ(found->at("stops"), read.at("stops"));
  EXPECT_EQ(found->at("damage"), "");
}

TEST_F(StoreTest, EveryFormatIsWritten) {
  for (const char* format : {"pgm", "masks", "geojson", "lif", "zones", "rmf", "graphml", "svg",
                             "png", "g2o", "tum", "carmen", "pb"}) {
    const std::string out = path(std::string("map.") + format);
    const StoreOutcome outcome = store({"export", map_, "--format", format, "--out", out});
    EXPECT_EQ(outcome.code, 0) << format << ": " << outcome.err;
  }
  EXPECT_EQ(read_file(path("map.pb")), read_file(map_));
  EXPECT_EQ(read_file(path("map.tum")), read_file(path("out/trajectory.tum")));
  EXPECT_EQ(read_file(path("map.svg")).substr(0, 5), "<?xml");
  for (const char* name : {"map.pgm", "map.yaml", "map.masks_keepout.pgm", "map.masks_speed.yaml",
                           "map.geojson", "map.lif", "map.zones", "map.rmf", "map.carmen"}) {
    EXPECT_GT(std::filesystem::file_size(path(name)), 20U) << name;
  }
}

TEST_F(StoreTest, WhatWasExportedIsImported) {
  const auto round_trip = [&](const std::string& format) {
    const std::string file = path("one." + format);
    EXPECT_EQ(store({"export", map_, "--format", format, "--out", file}).code, 0);
    const StoreOutcome in = store({"import", file, "--format", format, "--out", path("in.pb")});
    EXPECT_EQ(in.code, 0) << in.err;
    const std::string again = path("two." + format);
    EXPECT_EQ(store({"export", path("in.pb"), "--format", format, "--out", again}).code, 0);
    return read_file(file) == read_file(again);
  };
  EXPECT_TRUE(round_trip("graphml"));
  // The export of a grid: the image of the second export equals the first.
  EXPECT_EQ(store({"export", map_, "--format", "pgm", "--out", path("g")}).code, 0);
  EXPECT_EQ(store({"import", path("g.yaml"), "--format", "pgm", "--out", path("g.pb")}).code, 0);
  EXPECT_EQ(store({"export", path("g.pb"), "--format", "pgm", "--out", path("h")}).code, 0);
  EXPECT_EQ(read_file(path("g.pgm")), read_file(path("h.pgm")));
  const auto read = nlohmann::json::parse(store({"info", path("g.pb"), "--json"}).out);
  EXPECT_GT(read.at("branches"), 0);
}

TEST_F(StoreTest, AnImportWithoutAFormatNamesTheOneThatItRecognized) {
  EXPECT_EQ(store({"export", map_, "--format", "graphml", "--out", path("one.graphml")}).code, 0);
  const StoreOutcome in = store({"import", path("one.graphml"), "--out", path("in.pb")});
  EXPECT_EQ(in.code, 0) << in.err;
  EXPECT_THAT(in.err, HasSubstr("read as 'graphml', because it is GraphML"));
  std::ofstream(path("notes.txt")) << "nothing: here\n";
  const StoreOutcome unknown = store({"import", path("notes.txt"), "--out", path("none.pb")});
  EXPECT_EQ(unknown.code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("notes.txt: its content does not show the format"));
}

TEST_F(StoreTest, ZonesAreLaidOverAMap) {
  std::ofstream(path("zones.yaml"))
      << "zones:\n  - {name: ramp, kind: slow, value: 0.3, polygon: [[0, 0], [1, 0], [1, 1]]}\n";
  EXPECT_EQ(store({"import", path("zones.yaml"), "--format", "drawing", "--into", map_, "--out",
                   path("with.pb")})
                .code,
            0);
  EXPECT_THAT(store({"info", path("with.pb")}).out, HasSubstr("1 zones"));
  EXPECT_EQ(store({"export", path("with.pb"), "--format", "zones", "--out", path("z.json")}).code,
            0);
  EXPECT_THAT(read_file(path("z.json")), HasSubstr("SPEED_LIMIT"));
}

TEST_F(StoreTest, DamageIsToldAndWhatIsLeftIsSaved) {
  const std::string bytes = read_file(map_);
  std::ofstream(path("cut.pb"), std::ios::binary) << bytes.substr(0, bytes.size() * 2 / 3);
  const StoreOutcome check = store({"check", path("cut.pb")});
  EXPECT_EQ(check.code, 3);
  EXPECT_THAT(check.err, HasSubstr("cut.pb: cut short or damaged"));
  EXPECT_THAT(store({"list", path("")}).out, HasSubstr("cut short or damaged"));
  const StoreOutcome for_programs = store({"check", path("cut.pb"), "--json"});
  EXPECT_EQ(for_programs.code, 3);
  const auto checked = nlohmann::json::parse(for_programs.out);
  EXPECT_EQ(checked.at("good"), false);
  EXPECT_THAT(checked.at("damage"), HasSubstr("cut short or damaged"));
  EXPECT_THAT(store({"list", path(""), "--json"}).out, HasSubstr("cut short or damaged"));
  const StoreOutcome repair = store({"repair", path("cut.pb"), "--out", path("saved.pb")});
  EXPECT_EQ(repair.code, 0) << repair.err;
  EXPECT_THAT(repair.out, HasSubstr("cut short"));
  EXPECT_EQ(store({"check", path("saved.pb")}).code, 0);
}

TEST_F(StoreTest, ARoomThatLooksAlikeFromBothSidesIsNotAligned) {
  const StoreOutcome align = store({"align", map_, map_, "--json"});
  EXPECT_EQ(align.code, 1);
  EXPECT_THAT(align.err, HasSubstr("not aligned: ambiguous"));
  EXPECT_EQ(nlohmann::json::parse(align.out).at("found"), false);
  // A second map of the same session is an older or newer version of it.
  const StoreOutcome merge = store({"merge", map_, map_, "--out", path("twice.pb")});
  EXPECT_EQ(merge.code, 3);
  EXPECT_FALSE(std::filesystem::exists(path("twice.pb")));
}

TEST_F(StoreTest, SessionsAreNamedAndTheOnlyOneStays) {
  const std::string info = store({"info", map_}).out;
  const std::size_t at = info.find("session    ");
  ASSERT_NE(at, std::string::npos) << info;
  const std::string session = info.substr(at + 11, 16);
  const StoreOutcome removed = store({"remove-session", map_, session, "--out", path("none.pb")});
  EXPECT_EQ(removed.code, 3);
  EXPECT_THAT(removed.err, HasSubstr("all stops belong to it"));
  EXPECT_EQ(store({"remove-session", map_, "monday", "--out", path("none.pb")}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("none.pb")));
}

TEST_F(StoreTest, WrongCallsAndFilesAreToldInOneLine) {
  EXPECT_EQ(store({}).code, 2);
  EXPECT_EQ(store({"export", map_, "--format", "dxf", "--out", path("x")}).code, 2);
  const StoreOutcome none = store({"info", path("none.pb")});
  EXPECT_EQ(none.code, 3);
  EXPECT_THAT(none.err, HasSubstr("none.pb"));
  std::ofstream(path("bad.json")) << "{\"features\": 3}";
  const StoreOutcome bad =
      store({"import", path("bad.json"), "--format", "geojson", "--out", path("x.pb")});
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.err, HasSubstr("bad.json: features: expected an array, got 3"));
  EXPECT_FALSE(std::filesystem::exists(path("x.pb")));
}

}  // namespace
}  // namespace topogeo::test
