// Telegrams of SICK lasers on a network (TiM, LMS1xx): CoLa A is text, CoLa B is binary.
//
// Source: SICK, "Telegram Listing: LMS1xx, LMS5xx, TiM2xx, TiM5xx, TiM7xx ..." (8014631) and the
// operating instructions of the TiM781.
// - CoLa A: STX, name and fields separated by blanks, ETX. Numbers are hexadecimal without leading
//   zeros.
// - CoLa B: four times STX, the length of the body in four bytes, the body, and the XOR of the
// body.
//   The body is the name, a blank, and the same fields as big-endian bytes.
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

enum class ColaDialect : std::uint8_t { kText, kBinary };

/// A telegram: a name of two words, for example "sRN DeviceIdent", and its fields.
struct ColaTelegram {
  ColaDialect dialect = ColaDialect::kText;
  std::string name;    ///< kind and command, for example "sAN SetAccessMode"
  std::string fields;  ///< the bytes after the name and a blank
  bool operator==(const ColaTelegram&) const = default;
};
[[nodiscard]] std::vector<std::uint8_t> cola_bytes(const ColaTelegram& telegram);

/// Reads fields one by one. After a missing or invalid field, ok() is false and all further fields
/// are 0.
class ColaFields {
 public:
  explicit ColaFields(const ColaTelegram& telegram)
      : dialect_(telegram.dialect), rest_(telegram.fields) {}

  /// `bytes`: size of the number in CoLa B, 1 to 4.
  [[nodiscard]] std::uint32_t number(std::size_t bytes);
  [[nodiscard]] float real();
  /// A text of `size` characters.
  [[nodiscard]] std::string text(std::size_t size);
  /// A text that follows its length.
  [[nodiscard]] std::string sized_text();
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  [[nodiscard]] std::string_view take(std::size_t size);
  [[nodiscard]] std::string_view word();

  ColaDialect dialect_;
  std::string_view rest_;
  bool ok_ = true;
};

/// Writes the fields of a telegram, in the order of the calls.
class ColaWriter {
 public:
  explicit ColaWriter(ColaDialect dialect) : dialect_(dialect) {}

  ColaWriter& number(std::uint32_t value, std::size_t bytes);
  ColaWriter& real(float value);
  ColaWriter& text(std::string_view value);
  ColaWriter& sized_text(std::string_view value);
  [[nodiscard]] ColaTelegram telegram(std::string name) const {
    return {dialect_, std::move(name), fields_};
  }

 private:
  void word(const std::string& text);

  ColaDialect dialect_;
  std::string fields_;
};

/// The measured values of LMDscandata.
struct ColaScan {
  std::uint8_t status = 0;  ///< 0 good, 1 error, 2 window dirty, 5 too dirty
  std::uint16_t scan_counter = 0;
  std::uint32_t start_us = 0;  ///< laser's time at the zero index, before the first beam; wraps
  std::uint32_t sent_us = 0;   ///< laser's time when the scan was complete; wraps
  double turns_hz = 0.0;
  double first_deg = 0.0;  ///< bearing of the first beam: counter-clockwise, 90 is ahead
  double step_deg = 0.0;
  std::vector<float> ranges_m;  ///< 0: no return
};
inline constexpr std::string_view kColaScanName = "sSN LMDscandata";
/// Decodes a scan; empty if the telegram is none, or if a field is missing or out of range.
[[nodiscard]] std::optional<ColaScan> cola_scan(const ColaTelegram& telegram);
[[nodiscard]] ColaTelegram cola_telegram(const ColaScan& scan, ColaDialect dialect);

/// Finds telegrams of both dialects in a stream of bytes that may be cut at any byte.
class ColaReader {
 public:
  [[nodiscard]] std::vector<ColaTelegram> read(std::span<const std::uint8_t> bytes);
  void clear() { buffer_.clear(); }
  [[nodiscard]] std::uint64_t noise_bytes() const { return noise_bytes_; }
  [[nodiscard]] std::uint64_t bad_checksum() const { return bad_checksum_; }

 private:
  enum class Need : std::uint8_t { kMore, kNoise, kFound };
  [[nodiscard]] Need take(std::size_t at, ColaTelegram& telegram, std::size_t& size);

  std::vector<std::uint8_t> buffer_;
  std::uint64_t noise_bytes_ = 0;
  std::uint64_t bad_checksum_ = 0;
};

}  // namespace topogeo::devices
