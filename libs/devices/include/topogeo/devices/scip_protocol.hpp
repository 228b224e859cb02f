// Commands and answers of Hokuyo lasers.
//
// Source: Hokuyo Automatic, "Communication Protocol Specification for SCIP2.0 Standard"
// (C-42-03320B) and "... for UST Series 10LX/20LX" (C-42-04076). A command is a line of text. Its
// answer is its echo, a status of two characters with a sum, lines of data with a sum each, and an
// empty line. Numbers are coded with six bits a character, from 0x30 on, the highest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace topogeo::devices {

/// Sum of the characters, six bits of it, as a character.
[[nodiscard]] char scip_sum(std::string_view text);
/// `value` in `characters` characters, of which it must not need more.
[[nodiscard]] std::string scip_encode(std::uint32_t value, std::size_t characters);
/// Empty if a character is none of the code, or if there are more than four.
[[nodiscard]] std::optional<std::uint32_t> scip_decode(std::string_view text);

/// An answer without its echo.
struct ScipAnswer {
  std::string status;              ///< "00", "99" of a scan, or the number of an error
  std::vector<std::string> lines;  ///< data, without sums
};
/// The answer in `text`, which ends before the empty line, to the command with this echo; what
/// stands before the last such echo is ignored. Empty without the echo or with a wrong sum.
[[nodiscard]] std::optional<ScipAnswer> scip_answer(std::string_view text, std::string_view echo);
/// The bytes of an answer with its empty line; VV, PP and II have a ';' before each sum.
[[nodiscard]] std::string scip_text(std::string_view echo, const ScipAnswer& answer);
[[nodiscard]] std::string scip_text_of_fields(std::string_view echo, const ScipAnswer& answer);

/// The fields of an answer to VV, PP or II: "NAME:value" in each line.
using ScipFields = std::vector<std::pair<std::string, std::string>>;
/// Empty without the echo, or if a line has another form or a wrong sum.
[[nodiscard]] std::optional<ScipFields> scip_fields(std::string_view text, std::string_view echo);
/// The value of a field; empty if there is none.
[[nodiscard]] std::string_view scip_field(const ScipFields& fields, std::string_view name);

/// The sweep of a laser, as it reports it (PP).
struct ScipParameters {
  std::string model;
  unsigned range_min_mm = 0;
  unsigned range_max_mm = 0;
  unsigned steps_of_turn = 0;
  unsigned first_step = 0;
  unsigned last_step = 0;
  unsigned front_step = 0;
  unsigned rpm = 0;
  bool operator==(const ScipParameters&) const = default;

  [[nodiscard]] std::size_t beams() const { return last_step - first_step + 1; }
};
/// Empty if a field is missing or out of range.
[[nodiscard]] std::optional<ScipParameters> scip_parameters(const ScipFields& fields);
[[nodiscard]] ScipFields scip_fields_of(const ScipParameters& parameters);

enum class ScipScanKind : std::uint8_t {
  kTwoCharacters,    ///< MS: up to 4,095 mm
  kThreeCharacters,  ///< MD: up to 262,143 mm
  kIntensities       ///< ME: as MD, each distance followed by an intensity
};
/// Distances of this or more have this number in two characters.
inline constexpr std::uint32_t kScipTwoCharacterMost = 4095;
/// Scans without end, of all steps.
struct ScipScanRequest {
  ScipScanKind kind = ScipScanKind::kThreeCharacters;
  unsigned first_step = 0;
  unsigned last_step = 0;
};
/// The command; its echo stands above each scan.
[[nodiscard]] std::string scip_command(const ScipScanRequest& request);

struct ScipScan {
  std::uint32_t time_ms = 0;  ///< of the laser's clock at step 0, 24 bits
  std::vector<std::uint32_t> distances_mm;
  std::vector<std::uint32_t> intensities;  ///< of kIntensities
};
inline constexpr std::uint32_t kScipTimeWrap_ms = 1U << 24U;
/// Empty if the answer has another length, or characters that are none of the code.
[[nodiscard]] std::optional<ScipScan> scip_scan(const ScipAnswer& answer,
                                                const ScipScanRequest& request);
[[nodiscard]] ScipAnswer scip_answer_of(const ScipScan& scan, const ScipScanRequest& request);
/// The time in an answer to TM1.
[[nodiscard]] std::optional<std::uint32_t> scip_time_ms(const ScipAnswer& answer);

/// Cuts a stream of bytes at empty lines.
class ScipReader {
 public:
  /// The texts before the empty lines that have come.
  [[nodiscard]] std::vector<std::string> read(std::span<const std::uint8_t> bytes);
  void clear() { text_.clear(); }
  /// Bytes dropped because no empty line came.
  [[nodiscard]] std::uint64_t noise_bytes() const { return noise_bytes_; }

 private:
  std::string text_;
  std::uint64_t noise_bytes_ = 0;
};

}  // namespace topogeo::devices
