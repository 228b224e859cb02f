#include "orders/route_preview.hpp"

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

TEST(RoutePreview, WithoutAMapThereIsNoRoute) {
  const Answer answer = preview_route({}, {0.0, 0.0, 0.0}, {{1.0, 1.0}}, {}, {});
  EXPECT_EQ(answer.status, 200U);
  EXPECT_NE(answer.body.find(R"("found":false)"), std::string::npos) << answer.body;
}

}  // namespace
}  // namespace topogeo::web
