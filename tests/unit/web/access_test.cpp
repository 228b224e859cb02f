#include "server/access.hpp"

#include <gmock/gmock.h>

#include "server/rate_limit.hpp"

namespace topogeo::web {
namespace {

TEST(Access, TokensAreLongAndDiffer) {
  EXPECT_EQ(new_token().size(), 32U);
  EXPECT_NE(new_token(), new_token());
}

TEST(Access, OnlyTheTokenAuthorizes) {
  EXPECT_TRUE(is_authorized("Bearer secret", "secret"));
  EXPECT_FALSE(is_authorized("Bearer secreT", "secret"));
  EXPECT_FALSE(is_authorized("Bearer secre", "secret"));
  EXPECT_FALSE(is_authorized("Bearer secrets", "secret"));
  EXPECT_FALSE(is_authorized("Bearer ", "secret"));
  EXPECT_FALSE(is_authorized("secret", "secret"));
  EXPECT_FALSE(is_authorized("Basic secret", "secret"));
  EXPECT_FALSE(is_authorized("", "secret"));
  EXPECT_FALSE(is_authorized("Bearer ", "")) << "without a token nobody may write";
}

TEST(Access, AForeignNameOfThisMachineIsNoOwnHost) {
  EXPECT_TRUE(is_own_host("127.0.0.1:8080", {}));
  EXPECT_TRUE(is_own_host("[::1]:8080", {}));
  EXPECT_TRUE(is_own_host("LocalHost", {}));
  EXPECT_TRUE(is_own_host("192.168.1.7", {}));
  EXPECT_TRUE(is_own_host("robot:8080", {"Robot"}));
  EXPECT_FALSE(is_own_host("evil.example", {"robot"}));
  EXPECT_FALSE(is_own_host("localhost.evil.example:8080", {"robot"}));
  EXPECT_FALSE(is_own_host("1.evil.example", {}));
  EXPECT_FALSE(is_own_host("", {""}));
  EXPECT_FALSE(is_own_host("[::1", {}));
}

TEST(Access, OnlyOwnPagesMayAsk) {
  EXPECT_TRUE(is_own_origin("", "robot:8080", {})) << "a program, not a page";
  EXPECT_TRUE(is_own_origin("http://robot:8080", "robot:8080", {}));
  EXPECT_TRUE(is_own_origin("https://Robot:8080", "robot:8080", {}));
  EXPECT_FALSE(is_own_origin("http://robot:8081", "robot:8080", {}));
  EXPECT_FALSE(is_own_origin("http://evil.example", "robot:8080", {}));
  EXPECT_FALSE(is_own_origin("null", "robot:8080", {}));
  EXPECT_TRUE(is_own_origin("https://desk.example", "robot:8080", {"https://desk.example"}));
}

TEST(Access, ASubprotocolMayShowTheToken) {
  const auto offered = [](std::string_view list) { return offers_token(names_in(list), "aZ1"); };
  EXPECT_TRUE(offered("topogeo, token.615a31"));
  EXPECT_TRUE(offered("token.615a31 ,\ttopogeo"));
  EXPECT_FALSE(offered("token.615a32"));
  EXPECT_FALSE(offered("token."));
  EXPECT_FALSE(offered(""));
  EXPECT_FALSE(offers_token({"token."}, "")) << "nobody may write";
}

TEST(RateLimit, HoldsInTheLongRunAndAllowsABurst) {
  RateLimit limit(10.0, 5.0);
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += limit.take(1.0) ? 1 : 0;
  EXPECT_EQ(taken, 5) << "at once";
  for (int i = 0; i < 1000; ++i) taken += limit.take(1.0 + 0.01 * (i + 1)) ? 1 : 0;
  EXPECT_NEAR(taken, 105, 1) << "and ten seconds later";
}

}  // namespace
}  // namespace topogeo::web
