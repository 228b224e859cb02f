#include "revocation_list.hpp"

#include <system_error>

namespace topogeo::messaging {

RevocationList::RevocationList(const std::filesystem::path& folder)
    : file_(folder / "revoked.pem"), last_(written()) {}

bool RevocationList::take_change() {
  const auto now = written();
  if (now == last_) return false;
  last_ = now;
  return true;
}

std::filesystem::file_time_type RevocationList::written() const {
  if (file_.empty()) return last_;
  std::error_code none;
  const auto time = std::filesystem::last_write_time(file_, none);
  return none ? std::filesystem::file_time_type::min() : time;
}

}  // namespace topogeo::messaging
