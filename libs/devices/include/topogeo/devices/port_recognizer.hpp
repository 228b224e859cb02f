// Recognizes a device by the bytes that it sends: scans and reports of devices that send by
// themselves, and answers to harmless questions (port_search.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/cola_protocol.hpp"
#include "topogeo/devices/create_protocol.hpp"
#include "topogeo/devices/kobuki_protocol.hpp"
#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/devices/lds_packet.hpp"
#include "topogeo/devices/pioneer_protocol.hpp"
#include "topogeo/devices/rplidar_decoder.hpp"
#include "topogeo/devices/scip_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_telegram.hpp"
#include "topogeo/devices/text_base_protocol.hpp"
#include "topogeo/devices/ydlidar_packet.hpp"

namespace topogeo::devices {

enum class DeviceKind : std::uint8_t { kLaser, kBase };

/// A device that has a driver.
struct RecognizedDevice {
  DeviceKind kind = DeviceKind::kLaser;
  std::string_view model;  ///< value of laser.model or base.model
  LineSettings line;
  std::string device{};  ///< name and version that it reports; empty: none
  std::string note{};    ///< what the bytes leave open; empty: nothing
};

/// The bytes of one device at one setting of the line.
class PortRecognizer {
 public:
  /// Question that the device was asked, if any.
  enum class Question : std::uint8_t {
    kNone,
    kRpLidarInfo,
    kYdLidarInfo,
    kSickStatus,
    kScipVersion,
    kColaName
  };

  explicit PortRecognizer(const LineSettings& line, Question asked = Question::kNone);

  /// The device, as soon as its bytes suffice.
  [[nodiscard]] std::optional<RecognizedDevice> receive(std::span<const std::uint8_t> bytes,
                                                        std::int64_t now_ns);

 private:
  using Found = std::optional<RecognizedDevice>;
  [[nodiscard]] Found base_line(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found kobuki_frames(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found create_frames(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found pioneer_packets(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found ldrobot_packets(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found lds_packets(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found ydlidar_packets(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found rplidar_samples(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found rplidar_answer(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found sick_telegram(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  [[nodiscard]] Found scip_answer(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Found cola_answer(std::span<const std::uint8_t> bytes);
  [[nodiscard]] RecognizedDevice laser(std::string_view model) const;

  LineSettings line_;
  Question asked_;
  TextBaseReader text_;
  CreateDecoder create_;
  int create_frames_ = 0;
  KobukiDecoder kobuki_;
  int kobuki_frames_ = 0;
  PioneerReader pioneer_;
  int pioneer_reports_ = 0;
  LdDecoder ldrobot_;
  std::vector<LdPacket> ld_packets_;
  LdsDecoder xv11_{kXv11, LdsChecksum::kDrop};
  LdsDecoder lds01_{kLds01, LdsChecksum::kLearn};
  int xv11_packets_ = 0;
  int lds01_packets_ = 0;
  YdDecoder ydlidar_;
  int yd_packets_ = 0;
  std::deque<std::uint8_t> rp_bytes_;  // the last ones, for the samples of a scan
  RpDecoder rplidar_;
  SickDecoder sick_;
  ScipReader scip_;
  ColaReader cola_;
};

}  // namespace topogeo::devices
