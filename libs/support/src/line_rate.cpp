#include "topogeo/support/line_rate.hpp"

// The kernel's own header, because termios2 is not in termios.h, which conflicts with it.
#include <asm/termbits.h>
#include <sys/ioctl.h>

namespace topogeo::support {

bool set_line_rate(int terminal, std::uint32_t baud) {
  termios2 settings{};
  if (::ioctl(terminal, TCGETS2, &settings) != 0) return false;
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | CBAUD << IBSHIFT);
  settings.c_cflag |= BOTHER | BOTHER << IBSHIFT;
  settings.c_ispeed = baud;
  settings.c_ospeed = baud;
  return ::ioctl(terminal, TCSETS2, &settings) == 0 && line_rate(terminal) == baud;
}

std::uint32_t line_rate(int terminal) {
  termios2 settings{};
  return ::ioctl(terminal, TCGETS2, &settings) == 0 ? settings.c_ospeed : 0;
}

}  // namespace topogeo::support
