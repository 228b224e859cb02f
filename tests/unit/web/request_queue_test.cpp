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

std::vector<std::string> paths_of(RequestQueue& queue) {
  std::vector<std::string> paths;
  for (const auto& [one, respond] : queue.take()) paths.push_back(one.path);
  return paths;
}

TEST(RequestQueue, StrangersWaitForOrdersAndComeOneAtATime) {
  RequestQueue queue;
  EXPECT_TRUE(queue.empty());
  for (const char* path : {"shapes 1", "shapes 2", "shapes 3"}) {
    queue.push(request(path, false), [](const Answer&) {});
  }
  queue.push(request("goal", true), [](const Answer&) {});
  queue.push(request("release", true), [](const Answer&) {});
  EXPECT_THAT(paths_of(queue), ElementsAre("goal", "release", "shapes 1"));
  EXPECT_FALSE(queue.empty());
  EXPECT_THAT(paths_of(queue), ElementsAre("shapes 2"));
  queue.push(request("pause", true), [](const Answer&) {});
  EXPECT_THAT(paths_of(queue), ElementsAre("pause", "shapes 3"));
  EXPECT_TRUE(queue.empty());
  EXPECT_THAT(paths_of(queue), ElementsAre());
}

}  // namespace
}  // namespace topogeo::web
