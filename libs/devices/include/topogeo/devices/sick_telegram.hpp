// The telegrams of SICK PLS and LMS lasers:
//
//   STX (02), address, length (two bytes, low first), `length` bytes, check word (low byte first)
//
// The host's telegrams carry an address below 80 and a command; the sensor's carry an address with
// bit 7 set, the command's number plus 80, and a status byte at the end. Between telegrams the
// sensor sends single bytes: ACK (06) and NAK (15). There is no byte stuffing, so the start of a
// telegram may also occur inside another, and only the check word distinguishes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

inline constexpr std::uint8_t kSickStx = 0x02;
inline constexpr std::uint8_t kSickAck = 0x06;
inline constexpr std::uint8_t kSickNak = 0x15;
/// Bytes of a telegram that its length does not count.
inline constexpr std::size_t kSickFrame_bytes = 6;
/// The longest contents of a sensor's telegram, and of a host's.
inline constexpr std::size_t kSickLongestReply_bytes = 812;
inline constexpr std::size_t kSickLongestCommand_bytes = 64;

/// A host's telegram. Throws std::invalid_argument when command and data are longer than
/// kSickLongestCommand_bytes.
[[nodiscard]] std::vector<std::uint8_t> sick_command(std::uint8_t command,
                                                     std::span<const std::uint8_t> data = {},
                                                     std::uint8_t address = 0x00);

/// A sensor's telegram. Throws std::invalid_argument when `code`, data and status are longer than
/// kSickLongestReply_bytes or bit 7 of the address is not set.
[[nodiscard]] std::vector<std::uint8_t> sick_reply(std::uint8_t code,
                                                   std::span<const std::uint8_t> data,
                                                   std::uint8_t status,
                                                   std::uint8_t address = 0x80);

/// A received telegram; valid until the decoder gets more bytes.
struct SickTelegram {
  std::uint8_t address = 0;
  std::uint8_t code = 0;                   ///< the command or the reply's number
  std::span<const std::uint8_t> data{};    ///< after the code, without the status byte
  std::uint8_t status = 0;                 ///< 0 in a host's telegram, which has none
  std::int64_t arrived_ns = 0;             ///< arrival of the bytes that contained its last one
  std::size_t bytes_since = 0;             ///< number of those bytes after its last one
  [[nodiscard]] std::size_t size() const;  ///< all its bytes on the line
};

struct SickEvent {
  enum class Kind { kTelegram, kAck, kNak };
  Kind kind = Kind::kTelegram;
  SickTelegram telegram{};  ///< of kTelegram
};

/// Counts of received items, and of dropped ones by reason. Bytes of a dropped telegram are counted
/// once only.
struct SickCounters {
  std::uint64_t telegrams = 0;
  std::uint64_t acks = 0;
  std::uint64_t naks = 0;
  std::uint64_t bad_crc = 0;
  std::uint64_t implausible_length = 0;  ///< too long, or does not fit its number of readings
  std::uint64_t truncated = 0;           ///< followed by silence or by the start of another
  std::uint64_t noise_bytes = 0;         ///< outside of any apparent telegram
  std::uint64_t echoes = 0;              ///< the host's own telegrams, on a line that returns them
  bool operator==(const SickCounters&) const = default;
};

/// Finds telegrams and single bytes in an arbitrary stream. Preceding bytes never hide a valid
/// telegram: an apparent telegram that proves invalid costs one byte, and the search goes on behind
/// it. A truncated telegram is given up when the following bytes show it, or after a silence.
class SickDecoder {
 public:
  enum class Listener { kHost, kSensor };

  /// `byte_gap_ns`: the longest silence within a telegram.
  SickDecoder(Listener listener, std::int64_t byte_gap_ns);

  /// Appends bytes for `next`. A gap since the last bytes counts as silence.
  void push(std::span<const std::uint8_t> bytes, std::int64_t now_ns);

  /// The next telegram or single byte, in the order of the line.
  [[nodiscard]] std::optional<SickEvent> next();

  /// Gives up an incomplete telegram after too long a silence; call `next` after it.
  void tick(std::int64_t now_ns);
  /// Time at which `tick` would give up a telegram; the largest number if none is incomplete.
  [[nodiscard]] std::int64_t due_ns() const;

  /// Forgets the incomplete telegram uncounted, because the line changed its settings.
  void clear();

  [[nodiscard]] const SickCounters& counters() const { return counters_; }

 private:
  enum class Verdict { kTelegram, kEcho, kWait, kNoise, kImplausibleLength, kBadCrc };
  struct Judgement {
    Verdict verdict = Verdict::kNoise;
    std::size_t size = 0;  ///< of the telegram, as far as known
  };
  struct Arrival {
    std::uint64_t end = 0;  ///< offset in the stream
    std::int64_t at_ns = 0;
  };

  [[nodiscard]] Judgement judge(std::span<const std::uint8_t> bytes) const;
  [[nodiscard]] Judgement judge_contents(std::span<const std::uint8_t> bytes) const;
  [[nodiscard]] std::optional<SickEvent::Kind> single_byte() const;
  [[nodiscard]] SickTelegram take_telegram(std::size_t size);
  void skip_noise(std::size_t size);
  [[nodiscard]] bool starts_reply() const;
  void drop(Verdict verdict, std::size_t size);
  void settle_failure(bool by_telegram);
  void compact();
  [[nodiscard]] std::uint64_t position() const { return base_ + head_; }
  [[nodiscard]] std::uint64_t end() const { return base_ + buffer_.size(); }

  Listener listener_;
  std::int64_t byte_gap_ns_;
  std::vector<std::uint8_t> buffer_;
  std::deque<Arrival> arrivals_;  ///< of the buffer's contents
  std::size_t head_ = 0;          ///< all bytes before it are handled
  std::uint64_t base_ = 0;        ///< offset of the buffer's first byte in the stream
  std::int64_t last_push_ns_ = 0;
  std::uint64_t silent_at_ = 0;      ///< the line was silent here; no telegram spans it
  std::uint64_t in_step_at_ = 0;     ///< a telegram or single byte ended here
  std::uint64_t counted_until_ = 0;  ///< bytes before here are counted as dropped
  std::uint64_t failed_until_ = 0;   ///< end of a telegram with a bad check word, 0: none
  SickCounters counters_;
};

}  // namespace topogeo::devices
