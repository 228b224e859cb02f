#include "web_options.hpp"

#include <gmock/gmock.h>

#include "topogeo/service/service_options.hpp"

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ServerConfig config_of(const std::vector<std::string>& origins) {
  WebOptions options;
  options.origins = origins;
  return server_config(options, "robot");
}

TEST(WebOptions, OriginsAreSitesAsBrowsersSendThem) {
  EXPECT_THAT(config_of({"https://desk.example", "http://desk.example:8443", "file://"}).origins,
              ElementsAre("https://desk.example", "http://desk.example:8443", "file://"));
  for (const char* wrong : {"desk.example", "https://desk.example/", "https://", "://desk", "*"}) {
    try {
      config_of({wrong});
      ADD_FAILURE() << wrong;
    } catch (const service::UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("--origin ") + wrong));
    }
  }
}

}  // namespace
}  // namespace topogeo::web
