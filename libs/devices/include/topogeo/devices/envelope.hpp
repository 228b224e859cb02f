// Envelopes: what a device on a network sends over its two links, as one stream of bytes for a
// driver. The port (udp://HOST:PORT) packs, the driver unpacks; an emulator packs its own.
//
// An envelope is "TE", the kind, the length in two bytes, the contents, and a check word of all of
// it (sick_crc.hpp), lower bytes first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace topogeo::devices {

enum class EnvelopeKind : std::uint8_t {
  kHost = 1,  ///< "ADDRESS:PORT" of this host, to which the device has to send its datagrams
  kReply,     ///< bytes of the connection for commands, cut anywhere
  kDatagram   ///< one datagram
};

struct Envelope {
  EnvelopeKind kind{};
  std::vector<std::uint8_t> contents;
};

/// Appends an envelope. Throws std::invalid_argument for contents of more than 65,535 bytes.
void put_envelope(std::vector<std::uint8_t>& bytes, EnvelopeKind kind,
                  std::span<const std::uint8_t> contents);

/// Finds envelopes in a stream of bytes that is cut anywhere.
class EnvelopeReader {
 public:
  [[nodiscard]] std::vector<Envelope> read(std::span<const std::uint8_t> bytes);
  void clear() { buffer_.clear(); }
  [[nodiscard]] std::uint64_t noise_bytes() const { return noise_bytes_; }
  [[nodiscard]] std::uint64_t bad_checksum() const { return bad_checksum_; }

 private:
  std::vector<std::uint8_t> buffer_;
  std::uint64_t noise_bytes_ = 0;
  std::uint64_t bad_checksum_ = 0;
};

}  // namespace topogeo::devices
