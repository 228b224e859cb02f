#include "server/request_queue.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::web {
namespace {

using testing::ElementsAre;

Request request(const std::string& path, bool authorized) {
  Request request;
  request.path = path;
  request.authorized = authorized;
  return request;
}

bool push(RequestQueue& queue, const std::string& path, bool authorized) {
  return queue.push(request(path, authorized), [](const Answer&) {});
}

std::vector<std::string> paths_of(const RequestQueue::Turn& turn) {
  std::vector<std::string> paths;
  for (const auto& [one, respond] : turn.requests) paths.push_back(one.path);
  return paths;
}

TEST(RequestQueue, StrangersWaitForOrdersAndComeOneAtATurn) {
  RequestQueue queue;
  EXPECT_TRUE(push(queue, "shapes 1", false)) << "the first one wakes the loop";
  EXPECT_FALSE(push(queue, "shapes 2", false));
  EXPECT_FALSE(push(queue, "goal", true));
  EXPECT_FALSE(push(queue, "release", true));
  RequestQueue::Turn turn = queue.take();
  EXPECT_THAT(paths_of(turn), ElementsAre("goal", "release", "shapes 1"));
  EXPECT_TRUE(turn.more);
  EXPECT_FALSE(push(queue, "pause", true)) << "another turn is to come";
  turn = queue.take();
  EXPECT_THAT(paths_of(turn), ElementsAre("pause", "shapes 2"));
  EXPECT_FALSE(turn.more);
  EXPECT_TRUE(push(queue, "shapes 3", false));
}

}  // namespace
}  // namespace topogeo::web
