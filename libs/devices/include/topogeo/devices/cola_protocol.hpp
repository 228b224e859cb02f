// Telegrams of SICK lasers on a network (TiM, LMS1xx): CoLa A, text, and CoLa B, bytes.
//
// Source: SICK, "Telegram Listing: LMS1xx, LMS5xx, TiM2xx, TiM5xx, TiM7xx ..." (8014631) and the
// operating instructions of the TiM781. CoLa A is STX, fields separated by blanks, ETX; numbers are
// hexadecimal without leading zeros. CoLa B is four times STX, the length in four bytes, the same
// fields as bytes, highest first, behind the name and a blank, and the XOR of all of them.
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

/// A telegram: "sRN DeviceIdent" and what follows.
struct ColaTelegram {
  ColaDialect dialect = ColaDialect::kText;
  std::string name;    ///< kind and command, for example "sAN SetAccessMode"
  std::string fields;  ///< behind the blank after the name
  bool operator==(const ColaTelegram&) const = default;
};
[[nodiscard]] std::vector<std::uint8_t> cola_bytes(const ColaTelegram& telegram);

/// Reads fields one by one. After a field that is missing or wrong, ok() is false and all further
/// ones are 0.
class ColaFields {
 public:
  explicit ColaFields(const ColaTelegram& telegram)
      : dialect_(telegram.dialect), rest_(telegram.fields) {}

  /// `bytes`: its size in CoLa B, up to 4.
  [[nodiscard]] std::uint32_t number(std::size_t bytes);
  [[nodiscard]] float real();
  /// `size` characters.
  [[nodiscard]] std::string text(std::size_t size);
  /// A text behind its length.
  [[nodiscard]] std::string sized_text();
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  [[nodiscard]] std::string_view take(std::size_t size);
  [[nodiscard]] std::string_view word();

  ColaDialect dialect_;
  std::string_view rest_;
  bool ok_ = true;
};

/// Writes fields.
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
  std::uint32_t sent_us = 0;   ///< when the scan was complete; wraps
  double turns_hz = 0.0;
  double first_deg = 0.0;  ///< 90 degrees are ahead, counter-clockwise
  double step_deg = 0.0;
  std::vector<float> ranges_m;  ///< 0: no return
};
inline constexpr std::string_view kColaScanName = "sSN LMDscandata";
/// Empty for another telegram, or if a field is missing or out of range.
[[nodiscard]] std::optional<ColaScan> cola_scan(const ColaTelegram& telegram);
[[nodiscard]] ColaTelegram cola_telegram(const ColaScan& scan, ColaDialect dialect);

/// Finds telegrams of both dialects in a stream of bytes that is cut anywhere.
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
