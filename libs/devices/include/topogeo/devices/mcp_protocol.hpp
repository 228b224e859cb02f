// The messages between an RWI base and its host, independent of the two dialects of its controller
// (MCP): mcp_ascii.hpp and mcp_binary.hpp.
//
// Compiled from public drivers of the B21, because no manual is public; this project has confirmed
// none of it on hardware.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

namespace topogeo::devices {

/// Commands; the value is the opcode of the binary dialect.
enum class McpCommand : std::uint8_t {
  kSync = 0x00,
  kVersion = 0x01,
  kKill = 0x02,  ///< both motors limp at once
  kShutdown = 0x03,
  kDirectMode = 0x09,    ///< ASCII: enter the binary dialect; binary: leave it
  kErrorDelay = 0x0A,    ///< 16 bits, 1/256 s
  kAcknowledge = 0x0B,   ///< 16 bits
  kFullDuplex = 0x0C,    ///< no known mnemonic
  kHalfDuplex = 0x0D,    ///< no echo
  kJoystickOff = 0x0E,   ///< 8 bits: 1 switches the joystick off, 0 on
  kReportOnce = 0x10,    ///< 32 bits: a mask of McpField
  kReportMask = 0x11,    ///< 32 bits: a mask of McpField
  kReportPeriod = 0x12,  ///< 16 bits, 1/256 s, 0 = off
  kFindIndex = 0x13,
  kLoadPosition = 0x14,           ///< 32 bits: x << 16 | y
  kLoadHeading = 0x15,            ///< 16 bits
  kWatchdog = 0x16,               ///< 16 bits, 1/256 s, 0 = off
  kTranslateVelocity = 0x20,      ///< 16 bits, encoder counts/s
  kTranslateAcceleration = 0x21,  ///< 16 bits, encoder counts/s^2
  kTranslateHalt = 0x22,
  kTranslateLimp = 0x23,
  kTranslateForward = 0x24,   ///< 32 bits, encoder counts
  kTranslateBackward = 0x25,  ///< 32 bits, encoder counts
  kTranslatePlus = 0x26,      ///< run forward until the next command
  kTranslateMinus = 0x27,
  kTranslateTorque = 0x2D,  ///< 8 bits
  kTranslateTo = 0x3B,      ///< 32 bits, absolute
  kTranslateWhere = 0x3C,
  kRotateVelocity = 0x40,      ///< 16 bits, rotation counts/s
  kRotateAcceleration = 0x41,  ///< 16 bits, rotation counts/s^2
  kRotateHalt = 0x42,
  kRotateLimp = 0x43,
  kRotatePositive = 0x44,  ///< 32 bits, rotation counts, clockwise on a B21
  kRotateNegative = 0x45,
  kRotatePlus = 0x46,  ///< run clockwise until the next command
  kRotateMinus = 0x47,
  kRotateTo = 0x5B,  ///< 32 bits, absolute; 0x80000000 is the heading at power-on
  kRotateWhere = 0x5C,
  kBatteryVoltage = 0x60,  ///< answer in 0.1 V
  kBatteryCurrent = 0x61,  ///< answer in 0.1 A
  kClock = 0x63,           ///< answer in 1/256 s
  kBumpStop = 0x64,        ///< 32 bits: 0 = the base stops by itself when it bumps, FFFF = never
  kIndexMask = 0x65,       ///< 8 bits
};

/// The two letters of the ASCII dialect; empty for a command that has none.
std::string_view mnemonic(McpCommand command);
/// The command for two letters; empty for unknown letters.
std::optional<McpCommand> command_of(std::string_view mnemonic);
/// The largest argument of a command; empty if it has no argument.
std::optional<std::uint32_t> largest_argument(McpCommand command);
/// Whether the base answers the command with a value.
bool is_query(McpCommand command);

/// A command with its argument, if any.
struct McpOrder {
  McpCommand command = McpCommand::kSync;
  std::uint32_t argument = 0;
  bool operator==(const McpOrder&) const = default;
};

/// Fields of a status report; the value is the bit of the request mask, and their order in the
/// report.
enum class McpField : std::uint8_t {
  kMask = 0,   ///< SRD, 32 bits: the mask itself
  kClock = 1,  ///< CLK, 32 bits, 1/256 s
  kGeneral = 2,
  kBumpers = 3,  ///< BBS: active low, FFFF if none is pressed
  kX = 4,        ///< BPX, BPY: position units from 0x8000; heading 0 is +y
  kY = 5,
  kHeading = 6,  ///< TPH: of the top plate, clockwise
  kBaseHeading = 7,
  kTranslateError = 8,
  kTranslateSpeed = 9,  ///< TVE: magnitude, encoder counts/s
  kTranslatePulse = 10,
  kTranslateStatus = 11,  ///< TSF: see McpPhase and the bits below
  kRotateError = 16,
  kRotateSpeed = 17,  ///< RVE: magnitude, rotation counts/s
  kRotatePulse = 18,
  kRotateStatus = 19,
};
inline constexpr std::size_t kMcpFields = 32;

constexpr std::uint32_t mask_bit(McpField field) {
  return std::uint32_t{1} << static_cast<unsigned>(field);
}
constexpr bool is_wide(std::size_t field) {
  return field == static_cast<std::size_t>(McpField::kMask) ||
         field == static_cast<std::size_t>(McpField::kClock);
}
/// The three letters of the field with that bit, 0..31.
std::string_view field_name(std::size_t field);

/// Bits 15-13 of the two status words.
enum class McpPhase : std::uint8_t {
  kStop = 0,
  kAccelerate = 1,
  kConstant = 2,
  kDecelerate = 3,
  kHalt = 4,
  kLimp = 5,
  kPower = 6,
  kTorque = 7
};
constexpr McpPhase phase_of(std::uint16_t status) {
  return static_cast<McpPhase>(status >> 13U);
}
inline constexpr std::uint16_t kMcpMeasuredNegative = 0x0800;
inline constexpr std::uint16_t kMcpCommandedNegative = 0x0100;

/// A status report. Fields that `mask` does not name are 0.
struct McpReport {
  std::uint32_t mask = 0;
  std::array<std::uint32_t, kMcpFields> fields{};

  [[nodiscard]] bool has(McpField field) const { return (mask & mask_bit(field)) != 0; }
  [[nodiscard]] std::uint32_t wide(McpField field) const {
    return fields[static_cast<std::size_t>(field)];
  }
  [[nodiscard]] std::uint16_t word(McpField field) const {
    return static_cast<std::uint16_t>(fields[static_cast<std::size_t>(field)]);
  }
  bool operator==(const McpReport&) const = default;
};

enum class McpEventKind : std::uint8_t {
  kBump,  ///< value: the bumper word
  kBatteryHigh,
  kBatteryLow,
  kTranslateError,
  kTranslateCurrent,
  kTranslateCleared,
  kRotateError,
  kRotateCurrent,
  kRotateCleared,
  kErrorCleared,
  kWatchdogExpired,
  kLostSync,  ///< the base does not find the start of our packets
  kIndex      ///< value: the state of its indices
};

/// A message that the base sends unasked.
struct McpEvent {
  McpEventKind kind = McpEventKind::kBump;
  std::uint32_t value = 0;
  bool operator==(const McpEvent&) const = default;
};

/// The answer to a query.
struct McpAnswer {
  McpCommand command = McpCommand::kSync;
  std::uint32_t value = 0;
  bool operator==(const McpAnswer&) const = default;
};

using McpMessage = std::variant<McpReport, McpEvent, McpAnswer>;

/// Reasons to drop received data.
enum class McpDrop : std::uint8_t {
  kUnknownLine,    ///< ASCII: a line outside the protocol
  kLongLine,       ///< ASCII: longer than any line of the protocol
  kBadReport,      ///< a report with a field that is wrong, missing or of the wrong length
  kGarbage,        ///< binary: bytes between frames, counted once for each run
  kLostEnd,        ///< binary: a frame that ends too early, too late or not at all
  kChecksum,       ///< binary
  kUnknownOpcode,  ///< binary
  kImplausible     ///< no base can have sent the report after the previous one
};
inline constexpr std::size_t kMcpDropKinds = 8;
using McpDrops = std::array<std::uint64_t, kMcpDropKinds>;
std::string_view drop_name(McpDrop drop);

/// The count for that reason.
constexpr std::uint64_t& count_of(McpDrops& drops, McpDrop drop) {
  return drops[static_cast<std::size_t>(drop)];
}
constexpr std::uint64_t count_of(const McpDrops& drops, McpDrop drop) {
  return drops[static_cast<std::size_t>(drop)];
}

}  // namespace topogeo::devices
