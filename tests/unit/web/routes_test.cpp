// The table of routes, and the table that docs/web_protocol.md has of it.
#include "routes.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>

namespace topogeo::web {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

std::string size_text(std::uint64_t bytes) {
  if (bytes == 0) return "none";
  const bool large = bytes >= std::uint64_t{1} << 20U;
  return large ? std::to_string(bytes >> 20U) + " MiB" : std::to_string(bytes >> 10U) + " KiB";
}

/// The table as in the documentation.
std::string markdown() {
  std::ostringstream out;
  out << "| method | path | token | body at most | purpose |\n|---|---|---|---|---|\n";
  for (const auto& [route, offer, after_stop, handler] : service_routes()) {
    out << "| " << (route.method == Method::kPost ? "POST" : "GET") << " | `" << route.path
        << (route.path.ends_with('/') ? "..." : "") << "` | "
        << (route.access == Access::kOperator ? "yes" : "no") << " | "
        << size_text(route.most_body_bytes) << " | " << route.help << " |\n";
  }
  return out.str();
}

std::string page() {
  std::ifstream file(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "docs/web_protocol.md");
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

TEST(Routes, TheTableOfTheDocumentationIsThatOfTheService) {
  EXPECT_THAT(page(), HasSubstr("\n\n" + markdown() + "\n"));
}

TEST(Routes, ARowIsCompleteAndItsPathIsUnique) {
  std::set<std::pair<Method, std::string_view>> paths;
  for (const auto& [route, offer, after_stop, handler] : service_routes()) {
    EXPECT_TRUE(paths.emplace(route.method, route.path).second) << route.path;
    EXPECT_EQ(&find_route(route.method, route.path)->route.path, &route.path) << route.path;
    EXPECT_THAT(route.help, Not(IsEmpty())) << route.path;
    EXPECT_NE(handler, nullptr) << route.path;
  }
}

TEST(Routes, OnlyOrdersAreOfferedAndHaveABody) {
  for (const auto& [route, offer, after_stop, handler] : service_routes()) {
    const bool post = route.method == Method::kPost;
    EXPECT_EQ(route.most_body_bytes > 0, post) << route.path;
    if (offer == Offer::kNever) continue;
    EXPECT_TRUE(post) << route.path;
    EXPECT_THAT(std::string(route.path), StartsWith(std::string(kApi)));
  }
}

TEST(Routes, AFolderLeadsToAllPathsBelowIt) {
  ASSERT_NE(find_route(Method::kGet, "/tiles/grid/0/0/0/0.png"), nullptr);
  EXPECT_EQ(find_route(Method::kGet, "/api/export/svg/map.svg")->route.path, "/api/export/");
  EXPECT_EQ(find_route(Method::kGet, "/api/export")->route.path, "/api/export");
}

TEST(Routes, AnUnknownPathOrMethodHasNoRoute) {
  EXPECT_EQ(find_route(Method::kGet, "/api/goal"), nullptr);
  EXPECT_EQ(find_route(Method::kPost, "/api/goals"), nullptr);
  EXPECT_EQ(find_route(Method::kPost, "/api/goal/"), nullptr);
  EXPECT_EQ(find_route(Method::kPost, ""), nullptr);
}

}  // namespace
}  // namespace topogeo::web
