// Settings that only SICK safety scanners on a network have.
#pragma once

#include <cstdint>

namespace topogeo::devices {

/// The network interface of the scanner, as its maker numbers it.
enum class SafetyInterface : std::uint8_t {
  kEfiPro = 0,
  kEthernetIp = 1,
  kProfinet = 3,
  kEthernet = 4
};

struct SafetySettings {
  std::uint8_t channel = 0;  ///< of the data output; [0, 3]
  SafetyInterface interface = SafetyInterface::kEthernet;
  /// Cut-off paths, [1, 20], whose fields count as the protective and the warning field; 0: none.
  std::uint8_t protective_path = 1;
  std::uint8_t warning_path = 0;
};

}  // namespace topogeo::devices
