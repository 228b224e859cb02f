#include "topogeo/devices/mcp_protocol.hpp"

#include <algorithm>

namespace topogeo::devices {
namespace {

struct Row {
  McpCommand command;
  std::string_view mnemonic;
  int argument_bits;  // 0: none
  bool query;
};

constexpr std::array kRows{
    Row{McpCommand::kSync, "", 0, false},
    Row{McpCommand::kVersion, "", 0, false},
    Row{McpCommand::kKill, "KI", 0, false},
    Row{McpCommand::kShutdown, "SH", 0, false},
    Row{McpCommand::kDirectMode, "DM", 0, false},
    Row{McpCommand::kErrorDelay, "ED", 16, false},
    Row{McpCommand::kAcknowledge, "EA", 16, false},
    Row{McpCommand::kFullDuplex, "", 0, false},
    Row{McpCommand::kHalfDuplex, "HD", 0, false},
    Row{McpCommand::kJoystickOff, "JD", 8, false},
    Row{McpCommand::kReportOnce, "", 32, false},
    Row{McpCommand::kReportMask, "SD", 32, false},
    Row{McpCommand::kReportPeriod, "SP", 16, false},
    Row{McpCommand::kFindIndex, "IX", 0, false},
    Row{McpCommand::kLoadPosition, "", 32, false},
    Row{McpCommand::kLoadHeading, "LH", 16, false},
    Row{McpCommand::kWatchdog, "WD", 16, false},
    Row{McpCommand::kTranslateVelocity, "TV", 16, false},
    Row{McpCommand::kTranslateAcceleration, "TA", 16, false},
    Row{McpCommand::kTranslateHalt, "TH", 0, false},
    Row{McpCommand::kTranslateLimp, "TL", 0, false},
    Row{McpCommand::kTranslateForward, "T>", 32, false},
    Row{McpCommand::kTranslateBackward, "T<", 32, false},
    Row{McpCommand::kTranslatePlus, "T+", 0, false},
    Row{McpCommand::kTranslateMinus, "T-", 0, false},
    Row{McpCommand::kTranslateTorque, "TT", 8, false},
    Row{McpCommand::kTranslateTo, "TP", 32, false},
    Row{McpCommand::kTranslateWhere, "TW", 0, true},
    Row{McpCommand::kRotateVelocity, "RV", 16, false},
    Row{McpCommand::kRotateAcceleration, "RA", 16, false},
    Row{McpCommand::kRotateHalt, "RH", 0, false},
    Row{McpCommand::kRotateLimp, "RL", 0, false},
    Row{McpCommand::kRotatePositive, "R>", 32, false},
    Row{McpCommand::kRotateNegative, "R<", 32, false},
    Row{McpCommand::kRotatePlus, "R+", 0, false},
    Row{McpCommand::kRotateMinus, "R-", 0, false},
    Row{McpCommand::kRotateTo, "RP", 32, false},
    Row{McpCommand::kRotateWhere, "RW", 0, true},
    Row{McpCommand::kBatteryVoltage, "BV", 0, true},
    Row{McpCommand::kBatteryCurrent, "BC", 0, true},
    Row{McpCommand::kClock, "CL", 0, true},
    Row{McpCommand::kBumpStop, "BE", 32, false},
    Row{McpCommand::kIndexMask, "IM", 8, false},
};

const Row& row_of(McpCommand command) {
  const auto* const row =
      std::ranges::find_if(kRows, [command](const Row& r) { return r.command == command; });
  return row == kRows.end() ? kRows.front() : *row;
}

constexpr std::array<std::string_view, kMcpFields> kFieldNames{
    "SRD", "CLK", "GSF", "BBS", "BPX", "BPY", "TPH", "BRH", "TPE", "TVE", "TPW",
    "TSF", "TC0", "TC1", "TC2", "TC3", "RPE", "RVE", "RPW", "RSF", "RC0", "RC1",
    "RC2", "RC3", "A01", "A23", "A45", "A67", "RX1", "RX2", "RX3", "RX4"};

constexpr std::array<std::string_view, kMcpDropKinds> kDropNames{
    "unknown line", "line too long", "bad report",     "garbage",
    "lost end",     "bad checksum",  "unknown opcode", "implausible report"};

}  // namespace

std::string_view mnemonic(McpCommand command) {
  return row_of(command).mnemonic;
}

std::optional<McpCommand> command_of(std::string_view mnemonic) {
  if (mnemonic.size() != 2) return std::nullopt;
  const auto* const row =
      std::ranges::find_if(kRows, [mnemonic](const Row& r) { return r.mnemonic == mnemonic; });
  if (row == kRows.end()) return std::nullopt;
  return row->command;
}

std::optional<std::uint32_t> largest_argument(McpCommand command) {
  const int bits = row_of(command).argument_bits;
  if (bits == 0) return std::nullopt;
  return 0xFFFFFFFFU >> static_cast<unsigned>(32 - bits);
}

bool is_query(McpCommand command) {
  return row_of(command).query;
}

std::string_view field_name(std::size_t field) {
  return kFieldNames.at(field);
}

std::string_view drop_name(McpDrop drop) {
  return kDropNames.at(static_cast<std::size_t>(drop));
}

}  // namespace topogeo::devices
