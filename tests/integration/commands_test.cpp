// Commands other than mapping: help, configuration, status, plan, demo, and the report of a run.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"
#include "topogeo/support/version.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class CommandsTest : public testing::Test {
 protected:
  Scratch scratch_;
};

TEST_F(CommandsTest, EveryProgramHasHelpAndVersion) {
  for (const char* name : {"topogeo", "sensor_gateway", "local_mapper", "localizer", "ga_worker",
                           "map_store", "planner", "simulator"}) {
    Program help(scratch_, name, {"--help"});
    EXPECT_EQ(help.wait(), 0) << name;
    EXPECT_THAT(help.out(), HasSubstr("Usage: " + std::string(name)));
    Program version(scratch_, name, {"--version"});
    EXPECT_EQ(version.wait(), 0) << name;
    EXPECT_THAT(version.out(), HasSubstr(support::kVersion));
  }
}

TEST_F(CommandsTest, EverySubcommandHasHelp) {
  for (const char* name : {"run", "map", "demo", "status", "workers", "plan", "dvl", "config",
                           "calibrate-odometry", "compare", "calibrate-laser", "simulate-route",
                           "record", "check-log", "base", "simulator", "store", "follow"}) {
    Program help(scratch_, "topogeo", {name, "--help"});
    EXPECT_EQ(help.wait(), 0) << name;
    EXPECT_THAT(help.out(), HasSubstr("Usage: topogeo " + std::string(name)));
  }
}

TEST_F(CommandsTest, WorkersListsThoseOfTheDomainAndSaysWhenThereAreNone) {
  const std::string domain = own_domain();
  Program none(scratch_, "topogeo", {"workers", "--domain", domain});
  EXPECT_EQ(none.wait(), 1);
  EXPECT_THAT(none.err(), HasSubstr("no search worker is alive on domain " + domain));
  Program worker(scratch_, "ga_worker", {"--domain", domain, "--slots", "3", "--name", "pc-2"});
  worker.wait_for_error_text("joined");
  std::string list;
  // On a busy machine a command may give up before it has found the worker.
  ASSERT_TRUE(wait_for("a list of the worker", [&] {
    Program command(scratch_, "topogeo", {"workers", "--domain", domain});
    const int code = command.wait();
    list = command.out();
    return code == 0;
  }));
  EXPECT_THAT(list, HasSubstr("pc-2"));
  EXPECT_THAT(list, HasSubstr("1 worker, 3 slots"));
  EXPECT_THAT(list, HasSubstr("idle"));
}

TEST_F(CommandsTest, WrongCommandLinesAreToldInOneLine) {
  const std::vector<std::vector<std::string>> lines = {
      {},
      {"fly"},
      {"map", "--out", "o"},
      {"run", "--log", "l", "--out", "o", "--workers", "-1"},
      {"run", "--log", "l", "--out", "o", "--domain", "233"},
      {"run", "--log", "l", "--out", "o", "--rate", "slow"},
      {"run", "--log", "l", "--out", "o", "--record", "drive.foo"},
      {"convert", "l", "drive.foo"},
      {"run", "--log", "l", "--out", "o", "--robot", std::string(33, 'x')},
      {"map", "--log", "l", "--out", "o", "--nonsense"},
      {"plan", "m", "--from", "1", "--to", "2,3"},
      // Refused before a file is read or a service starts.
      {"run", "--log", "l", "--out", "o", "--web", "--token", "short"},
      {"demo", "--out", "o", "--web", "--bind", "0.0.0.0"},
      {"view", "m", "--key", "k"},
  };
  for (const auto& line : lines) {
    Program program(scratch_, "topogeo", line);
    EXPECT_EQ(program.wait(), 2) << testing::PrintToString(line);
    const std::string err = program.err();
    EXPECT_THAT(err, StartsWith("topogeo: ")) << testing::PrintToString(line);
    EXPECT_EQ(err.find('\n'), err.size() - 1) << err;
  }
}

TEST_F(CommandsTest, APageIsRefusedAPortThatIsInUseBeforeAnythingStarts) {
  boost::asio::io_context context;
  const boost::asio::ip::tcp::endpoint any(boost::asio::ip::address_v4::loopback(), 0);
  const boost::asio::ip::tcp::acceptor other(context, any);
  const std::string port = std::to_string(other.local_endpoint().port());
  Program program(scratch_, "topogeo",
                  {"run", "--log", "l", "--out", scratch_ / "out", "--web", "--port", port});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.err(), HasSubstr("another program listens at 127.0.0.1 port " + port));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "out"));
}

// Services start one after the other, and on a busy machine one may be silent for a moment: the
// status is polled until all are there and well. The run is slow enough to last for that.
TEST_F(CommandsTest, StatusShowsTheServicesOfARun) {
  const std::string log = scratch_ / "log.clf.gz";
  write_log("floor", log);
  Program run(scratch_, "topogeo",
              {"run", "--log", log, "--out", scratch_ / "out", "--workers", "1", "--domain",
               own_domain(), "--rate", "0.1"});
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const auto answer = [&](std::vector<std::string> words, const auto& complete) {
    words.insert(words.begin(), "status");
    words.insert(words.end(), {"--domain", own_domain()});
    std::string out;
    EXPECT_TRUE(wait_for("a status in which all are there and well", [&] {
      Program status(scratch_, "topogeo", words);
      const int code = status.wait();
      out = status.out();
      return code == 0 && complete(out);
    }));
    return out;
  };
  const std::vector<std::string> names = {"sensor_gateway", "local_mapper", "localizer",
                                          "ga_worker",      "map_store",    "planner"};
  const std::string table = answer({}, [&](const std::string& out) {
    return std::ranges::all_of(names, [&](const std::string& name) { return has(out, name); });
  });
  EXPECT_THAT(table, StartsWith("SERVICE "));
  for (const std::string& name : names) EXPECT_THAT(table, HasSubstr(name));
  const std::string details =
      answer({"localizer"}, [&](const std::string& out) { return has(out, "tasks_sent"); });
  EXPECT_THAT(details, HasSubstr("tasks_sent"));
  EXPECT_THAT(details, Not(HasSubstr("map_store")));
  const std::string list =
      answer({"--json"}, [](const std::string& out) { return json::parse(out).size() >= 6; });
  EXPECT_GE(json::parse(list).size(), 6U);
}

TEST_F(CommandsTest, StatusWithoutServicesSaysSo) {
  Program status(scratch_, "topogeo", {"status", "--domain", own_domain()});
  EXPECT_EQ(status.wait(), 1);
  EXPECT_THAT(status.err(), HasSubstr("no service is alive on domain " + own_domain()));
  Program one(scratch_, "topogeo", {"status", "planner", "--json", "--domain", own_domain()});
  EXPECT_EQ(one.wait(), 1);
  EXPECT_EQ(one.out(), "[]\n");
  EXPECT_THAT(one.err(), HasSubstr("no 'planner' is alive on domain " + own_domain()));
}

TEST_F(CommandsTest, WorkersThatLeaveAtTheEndOfARunAreNoLoss) {
  const std::string log = scratch_ / "log.clf.gz";
  write_log("corridor", log);
  Program run(scratch_, "topogeo",
              {"run", "--log", log, "--out", scratch_ / "out", "--domain", own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.err(), Not(ContainsRegex("ga_worker.*(killed|ended|did not stop)")));
  EXPECT_THAT(run.out(), Not(HasSubstr("lost")));
  EXPECT_THAT(run.out(), Not(HasSubstr("fault")));
  const std::string localizer = read_file(scratch_ / "out" / "logs" / "localizer.log");
  // A machine without CPU time is another matter, which warnings report.
  for (const char* word : {"lost", "error"}) {
    EXPECT_THAT(localizer, Not(HasSubstr(word)));
  }
}

TEST_F(CommandsTest, PlansBetweenRoomsOfAMappedFloor) {
  const std::string log = scratch_ / "log.clf.gz";
  const std::string map = scratch_ / "out" / "map.pb";
  write_log("floor", log);
  Program mapping(scratch_, "topogeo", {"map", "--log", log, "--out", scratch_ / "out"});
  ASSERT_EQ(mapping.wait(), 0) << mapping.err();

  // The map's origin is (1.3, 1.2) of the floor, with the same axes: from the south room at (9.1,
  // 4.4) to the east room at (26.4, 15.2). The straight distance through the walls is 20.4 m.
  Program plan(scratch_, "topogeo",
               {"plan", map, "--from", "7.8,3.2", "--to", "25.1,14", "--json"});
  ASSERT_EQ(plan.wait(), 0) << plan.err();
  const json route = json::parse(plan.out());
  EXPECT_GT(route["length_m"], 22.0);
  EXPECT_LT(route["length_m"], 45.0);
  EXPECT_GE(route["min_clearance_m"], 0.3);
  EXPECT_GT(route["points"].size(), 5U);

  const std::string picture = scratch_ / "route.png";
  Program text(scratch_, "topogeo",
               {"plan", map, "--from", "7.8,3.2", "--to", "25.1,14", "--picture", picture});
  ASSERT_EQ(text.wait(), 0);
  EXPECT_THAT(text.out(), HasSubstr("length "));
  EXPECT_LE(std::ranges::count(text.out(), '\n'), 3) << text.out();
  EXPECT_THAT(read_file(picture), StartsWith("\x89PNG"));
  EXPECT_NEAR(route["points"].front()["x_m"].get<double>(), 7.8, 1e-9);
  EXPECT_NEAR(route["points"].back()["x_m"].get<double>(), 25.1, 1e-9);
  EXPECT_NEAR(route["points"].back()["y_m"].get<double>(), 14.0, 1e-9);

  // The branch nearest to (12, 3) is behind a wall, 12.1 m from the start: the route takes the
  // door.
  Program door(scratch_, "topogeo", {"plan", map, "--from", "0,0", "--to", "12,3", "--json"});
  ASSERT_EQ(door.wait(), 0) << door.err();
  EXPECT_GT(json::parse(door.out())["length_m"], 14.0);
  EXPECT_EQ(json::parse(door.out())["parts"].back()["on"], "off branch");
  Program walled(scratch_, "topogeo", {"plan", map, "--from", "0,0", "--to", "12,1"});
  EXPECT_EQ(walled.wait(), 1) << walled.out();
  EXPECT_THAT(walled.err(), ContainsRegex("no route: .*is the nearest place that can be reached"));

  // An obstacle on the route: the new one goes through other rooms.
  const json& middle = route["points"][route["points"].size() / 2];
  const double x_m = middle["x_m"];
  const double y_m = middle["y_m"];
  Program round(scratch_, "topogeo",
                {"plan", map, "--from", "7.8,3.2", "--to", "25.1,14", "--block",
                 fmt::format("{},{}", x_m, y_m), "--json"});
  ASSERT_EQ(round.wait(), 0) << round.err();
  const json detour = json::parse(round.out());
  EXPECT_GT(detour["length_m"], route["length_m"]);
  for (const json& point : detour["points"]) {
    EXPECT_GT(std::hypot(point["x_m"].get<double>() - x_m, point["y_m"].get<double>() - y_m), 0.3);
  }

  Program nowhere(scratch_, "topogeo", {"plan", map, "--from", "-90,3", "--to", "25.1,14"});
  EXPECT_EQ(nowhere.wait(), 1);
  EXPECT_THAT(nowhere.err(), HasSubstr("no route"));
}

TEST_F(CommandsTest, ListsArePrintedForPrograms) {
  const std::string floor = std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml";
  Program places(scratch_, "topogeo", {"places", floor, "--json"});
  ASSERT_EQ(places.wait(), 0) << places.err();
  const json listed = json::parse(places.out());
  EXPECT_GT(listed["zones"].size(), 5U);
  EXPECT_GT(listed["zones"][0]["area_m2"], 0.0);
  EXPECT_TRUE(listed["places"].is_array());
  Program snapshots(scratch_, "topogeo",
                    {"store", "snapshots", scratch_ / "none.sqlite", "--json"});
  ASSERT_EQ(snapshots.wait(), 0) << snapshots.err();
  EXPECT_EQ(json::parse(snapshots.out()), json::array());
}

TEST_F(CommandsTest, StatusAndTopTakeTheSameFlagsOfTheirKind) {
  for (const char* command : {"status", "workers", "top"}) {
    Program once(scratch_, "topogeo", {command, "--once", "--json", "--domain", own_domain()});
    EXPECT_EQ(once.wait(), 1) << once.err();
    EXPECT_THAT(once.err(), HasSubstr("is alive on domain"));
    Program both(scratch_, "topogeo", {command, "--once", "--watch"});
    EXPECT_EQ(both.wait(), 2) << both.err();
  }
}

TEST_F(CommandsTest, TheRobotOfTheEnvironmentIsThatOfEveryCommand) {
  const std::string log = scratch_ / "log.clf";
  write_log("corridor", log);
  ::setenv("TOPOGEO_ROBOT", "anna", 1);
  Program mapping(scratch_, "topogeo", {"map", log, "--out", scratch_ / "out"});
  const int code = mapping.wait();
  Program waiting(scratch_, "topogeo", {"follow", "--domain", own_domain()});
  waiting.wait_for_error_text("waiting for a map store of robot 'anna'");
  ::unsetenv("TOPOGEO_ROBOT");
  ASSERT_EQ(code, 0) << mapping.err();
  Program info(scratch_, "topogeo", {"store", "info", (scratch_ / "out" / "map.pb").string()});
  EXPECT_EQ(info.wait(), 0) << info.err();
  EXPECT_THAT(info.out(), HasSubstr("robot      anna"));
}

TEST_F(CommandsTest, PlanRefusesWhatIsNoMap) {
  Program missing(scratch_, "topogeo",
                  {"plan", scratch_ / "no.pb", "--from", "0,0", "--to", "1,1"});
  EXPECT_EQ(missing.wait(), 3);
  EXPECT_THAT(missing.err(), HasSubstr("no.pb"));
  const std::string log = scratch_ / "log.clf";
  write_log("corridor", log);
  Program wrong(scratch_, "topogeo", {"plan", log, "--from", "0,0", "--to", "1,1"});
  EXPECT_EQ(wrong.wait(), 3);
}

TEST_F(CommandsTest, SimulateRouteShowsStepsAndPictureOrSaysWhyThereIsNone) {
  const std::string world = std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml";
  const auto route = [&](const std::string& to, const std::string& picture) {
    std::vector<std::string> words{"simulate-route", world, "--from", "1,1", "--to", to};
    if (!picture.empty()) words.insert(words.end(), {"--picture", picture});
    return Program(scratch_, "topogeo", words);
  };
  const std::filesystem::path picture = scratch_ / "route.png";
  Program found = route("4.5,3", picture.string());
  ASSERT_EQ(found.wait(), 0) << found.err();
  EXPECT_THAT(found.out(), StartsWith("length "));  // round the table
  EXPECT_THAT(found.out(), HasSubstr("advance"));
  EXPECT_GT(std::filesystem::file_size(picture), 1000U);
  for (const auto& [to, reason] : std::vector<std::pair<std::string, std::string>>{
           {"kitchen", "no place has the name 'kitchen'"},
           {"100,1", "is outside of the grid"},
           {"5,4", "is in an obstacle"}}) {
    Program none = route(to, "");
    EXPECT_EQ(none.wait(), 1) << to;
    EXPECT_THAT(none.err(), HasSubstr(reason));
  }
}

TEST_F(CommandsTest, SimulateRouteAsksWhetherTheOutlineFits) {
  const std::string world = std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml";
  const std::filesystem::path config = scratch_ / "car.yaml";
  std::ofstream(config)
      << "base.minimum_turning_radius_m: 0.8\n"
         "robot.footprint: [[0.6, 0.3], [0.6, -0.3], [-0.6, -0.3], [-0.6, 0.3]]\n";
  const auto route_to = [&](const std::string& to) {
    return Program(
        scratch_, "topogeo",
        {"simulate-route", world, "--from", "1,1", "--to", to, "--config", config.string()});
  };
  Program fits = route_to("1,3");
  ASSERT_EQ(fits.wait(), 0) << fits.err();
  EXPECT_THAT(fits.out(), HasSubstr("path of the outline "));
  Program tour(scratch_, "topogeo",
               {"run", "--sim", world, "--out", scratch_ / "tour", "--config", config.string()});
  EXPECT_EQ(tour.wait(), 2);
  EXPECT_THAT(tour.err(), HasSubstr("turns on the spot"));
  // A corner where only the disc inside the outline has room.
  Program none = route_to("0.45,0.45");
  EXPECT_EQ(none.wait(), 1);
  EXPECT_THAT(none.err(), HasSubstr("wide enough for the outline of the robot"));
}

TEST_F(CommandsTest, SimulateRouteGoesRoundWhatIsSaidToStandInTheWay) {
  const std::string world = std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml";
  const auto length_m = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"simulate-route", world, "--from", "1,1", "--to", "1,3"};
    words.insert(words.end(), more.begin(), more.end());
    Program program(scratch_, "topogeo", words);
    EXPECT_EQ(program.wait(), 0) << program.err();
    return std::stod(program.out().substr(std::string("length ").size()));
  };
  const double free_m = length_m({});
  EXPECT_NEAR(free_m, 2.0, 0.01);
  EXPECT_GT(length_m({"--block", "1,2", "--block", "0.8,2"}), free_m + 0.05);
  for (const char* block : {"1;2", "500,500"}) {
    Program wrong(scratch_, "topogeo",
                  {"simulate-route", world, "--from", "1,1", "--to", "1,3", "--block", block});
    EXPECT_EQ(wrong.wait(), 2) << block;
    EXPECT_THAT(wrong.err(), HasSubstr("--block"));
  }
}

TEST_F(CommandsTest, DemoTellsTheErrorBeforeAndAfter) {
  const std::string world = std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml";
  Program demo(scratch_, "topogeo",
               {"demo", "--out", scratch_ / "out", "--world", world, "--domain", own_domain()});
  ASSERT_EQ(demo.wait(), 0) << demo.err();
  EXPECT_THAT(demo.out(), HasSubstr("odometry "));
  EXPECT_THAT(demo.out(), HasSubstr("corrected "));
  EXPECT_THAT(demo.out(), HasSubstr("map.png"));
  for (const char* file : {"floor.clf.gz", "truth.tum", "trajectory.tum", "odometry.tum", "map.pb",
                           "map.svg", "map.png", "report.json"}) {
    EXPECT_TRUE(std::filesystem::exists(scratch_ / "out" / file)) << file;
  }
}

TEST_F(CommandsTest, ReportOfRunAgreesWithThatOfMap) {
  const std::string log = scratch_ / "log.clf.gz";
  write_log("corridor", log);
  Program map(scratch_, "topogeo", {"map", "--log", log, "--out", scratch_ / "map", "--overlaps"});
  ASSERT_EQ(map.wait(), 0) << map.err();
  Program run(
      scratch_, "topogeo",
      {"run", "--log", log, "--out", scratch_ / "run", "--domain", own_domain(), "--overlaps"});
  ASSERT_EQ(run.wait(), 0) << run.err();

  const json of_map = json::parse(read_file(scratch_ / "map" / "report.json"));
  const json of_run = json::parse(read_file(scratch_ / "run" / "report.json"));
  for (const char* key : {"version", "log", "robot_id", "seed", "counts", "distance_m",
                          "loop_closures", "loop_candidates", "overlaps", "configuration"}) {
    EXPECT_EQ(of_run[key], of_map[key]) << key;
  }
  EXPECT_GT(of_map["counts"]["matches_tried"], 0);
  EXPECT_EQ(of_map["overlaps"].size() + 1, of_map["counts"]["stops"]);
  EXPECT_EQ(of_run["workers"], 2);
  for (const char* stage : {"sensor_gateway", "local_mapper", "localizer", "ga_worker_1",
                            "ga_worker_2", "map_store", "planner"}) {
    EXPECT_GT(of_run["stages"][stage]["cpu_s"], 0.0) << stage;
  }
  for (const char* stage : {"reading", "local_mapper", "localizer", "map_store", "writing"}) {
    EXPECT_TRUE(of_map["stages"].contains(stage)) << stage;
  }
}

}  // namespace
}  // namespace topogeo::test
