#include "web_options.hpp"

#include <gmock/gmock.h>

#include "topogeo/service/service_options.hpp"
#include "topogeo/support/file_content.hpp"
#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

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

TEST(WebOptions, LinkFileKeepsTheTokenFromWhatIsPrinted) {
  const support::TemporaryFolder folder("web_options");
  ServerConfig config;
  config.address = "127.0.0.1";
  config.token = "a-token-of-the-test";
  EXPECT_THAT(links(config, 8080, {}),
              HasSubstr("http://127.0.0.1:8080/#token=a-token-of-the-test"));
  const std::filesystem::path file = folder.path() / "link";
  const std::string printed = links(config, 8080, file);
  EXPECT_THAT(printed, Not(HasSubstr("a-token")));
  EXPECT_THAT(printed, HasSubstr("operator:   in " + file.string()));
  EXPECT_THAT(printed, HasSubstr("spectators: http://127.0.0.1:8080/\n"));
  EXPECT_EQ(support::file_content(file), "http://127.0.0.1:8080/#token=a-token-of-the-test\n");
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  EXPECT_THROW(links(config, 8080, folder.path() / "none/link"), service::BadInputError);
}

TEST(WebOptions, AlarmsAreKeptBesideTheAuditLog) {
  WebOptions options;
  EXPECT_EQ(kept_files(options, {}).alarms, "");
  options.audit_log = "logs/orders.jsonl";
  EXPECT_EQ(kept_files(options, {}).alarms, "logs/orders.alarms.jsonl");
  options.alarms = "alarms.jsonl";
  EXPECT_EQ(kept_files(options, {}).alarms, "alarms.jsonl");
}

}  // namespace
}  // namespace topogeo::web
