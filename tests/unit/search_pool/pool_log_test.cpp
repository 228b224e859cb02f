// Log lines about workers that join and leave.
#include "topogeo/search_pool/pool_log.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::search_pool {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;

class PoolNewsTest : public ::testing::Test {
 protected:
  std::vector<std::string> lines_;
  PoolLog log_{[this](const std::string& line) { lines_.push_back(line); }};
};

TEST_F(PoolNewsTest, NamesWorkersThatCameAndWent) {
  log_.workers({"a"}, seconds(1));
  log_.workers({"a"}, seconds(3));
  log_.workers({"a", "b"}, seconds(5));
  log_.workers({"b", "c", "d", "e", "f"}, seconds(7));
  log_.workers({}, seconds(9));
  EXPECT_THAT(lines_, ElementsAre("worker a joined, 1 worker", "worker b joined, 2 workers",
                                  "workers c, d, e and 1 more joined, worker a left, 5 workers",
                                  "workers b, c, d and 2 more left, 0 workers"));
}

TEST_F(PoolNewsTest, LogsThemOncePerSecondAtMost) {
  log_.workers({"a"}, milliseconds(0));
  log_.workers({"a", "b"}, milliseconds(100));
  log_.workers({"a"}, milliseconds(200));
  log_.workers({"a", "c"}, milliseconds(999));
  EXPECT_THAT(lines_, ElementsAre("worker a joined, 1 worker"));
  log_.workers({"a", "c"}, milliseconds(1000));
  EXPECT_THAT(lines_, ElementsAre("worker a joined, 1 worker", "worker c joined, 2 workers"))
      << "b came and went in between";
}

TEST_F(PoolNewsTest, LogsOnceThatItSearchesHere) {
  log_.searching_here(0, seconds(1));
  log_.searching_here(0, seconds(9));
  EXPECT_THAT(lines_, ElementsAre("no worker, searching in this process"));
  log_.workers({"a"}, seconds(10));
  log_.answered();
  log_.searching_here(1, seconds(11));
  log_.answered();
  log_.searching_here(0, milliseconds(11'500));
  log_.answered();
  log_.searching_here(0, seconds(12));
  EXPECT_THAT(lines_,
              ElementsAre("no worker, searching in this process", "worker a joined, 1 worker",
                          "no worker answers, searching in this process",
                          "no worker left, searching in this process"));
}

TEST_F(PoolNewsTest, LogsHowLongARecoveryTook) {
  log_.recovered({"pc7#12", WorkerFault::kLost, 3, milliseconds(312)});
  log_.recovered({"pc8#13", WorkerFault::kStalled, 1, milliseconds(1004)});
  EXPECT_THAT(lines_,
              ElementsAre("worker pc7#12 lost with 3 tasks, answered elsewhere after 0.31 s",
                          "worker pc8#13 stalled with 1 task, answered elsewhere after "
                          "1.00 s"));
}

}  // namespace
}  // namespace topogeo::search_pool
