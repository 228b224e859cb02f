#include "topogeo/support/logging.hpp"

#include <array>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "topogeo/support/log.hpp"
#include "topogeo/support/printable.hpp"

namespace topogeo::support {
namespace {

spdlog::level::level_enum parse_level(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, spdlog::level::level_enum>, 6> kLevels{
      {{"trace", spdlog::level::trace},
       {"debug", spdlog::level::debug},
       {"info", spdlog::level::info},
       {"warning", spdlog::level::warn},
       {"error", spdlog::level::err},
       {"off", spdlog::level::off}}};
  for (const auto& [name, level] : kLevels) {
    if (name == text) return level;
  }
  throw std::invalid_argument("log level '" + std::string(text) +
                              "': expected trace, debug, info, warning, error or off");
}

/// The text of a message without control characters, which may come from a peer.
class PrintableText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
              spdlog::memory_buf_t& out) override {
    const std::string text = printable({message.payload.data(), message.payload.size()});
    out.append(text.data(), text.data() + text.size());
  }

  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableText>();
  }
};

}  // namespace

void set_up_logging(std::string_view name, std::string_view level) {
  const auto parsed_level = parse_level(level);
  auto logger = std::make_shared<spdlog::logger>(
      std::string(name), std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableText>('*').set_pattern("%H:%M:%S.%e %^%l%$ %n: %*");
  logger->set_formatter(std::move(formatter));
  logger->set_level(parsed_level);
  logger->flush_on(spdlog::level::warn);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace topogeo::support
