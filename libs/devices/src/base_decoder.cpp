#include "topogeo/devices/base_decoder.hpp"

namespace topogeo::devices {
namespace {

std::variant<McpAsciiDecoder, McpBinaryDecoder> decoder_of(const BaseSettings& settings) {
  if (settings.dialect == BaseDialect::kAscii) return McpAsciiDecoder(settings.report_mask);
  return McpBinaryDecoder(settings.checksum);
}

}  // namespace

BaseDecoder::BaseDecoder(const BaseSettings& settings) : decoder_(decoder_of(settings)) {}

std::vector<McpMessage> BaseDecoder::decode(std::span<const std::uint8_t> bytes) {
  std::vector<McpMessage> messages;
  std::visit([&](auto& decoder) { decoder.decode(bytes, messages); }, decoder_);
  return messages;
}

void BaseDecoder::reset() {
  std::visit([](auto& decoder) { decoder.reset(); }, decoder_);
}

const McpDrops& BaseDecoder::drops() const {
  return std::visit([](const auto& decoder) -> const McpDrops& { return decoder.drops(); },
                    decoder_);
}

std::uint64_t BaseDecoder::echoes() const {
  const auto* const ascii = std::get_if<McpAsciiDecoder>(&decoder_);
  return ascii == nullptr ? 0 : ascii->echoes();
}

std::uint64_t BaseDecoder::checksum_warnings() const {
  const auto* const binary = std::get_if<McpBinaryDecoder>(&decoder_);
  return binary == nullptr ? 0 : binary->checksum_warnings();
}

}  // namespace topogeo::devices
