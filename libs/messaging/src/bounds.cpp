#include "bounds.hpp"

#include "topogeo/messaging/message.hpp"

namespace topogeo::messaging {

void BoundsCheck::schema(std::uint32_t version) {
  if (defect_ || version == msg::kSchemaVersion) return;
  if (version == kUnreadable) {
    defect_ = "the bytes are not a message of this topic";
    return;
  }
  defect_ = path_ + "schema_version " + std::to_string(version) + ", expected " +
            std::to_string(msg::kSchemaVersion);
}

void BoundsCheck::size(const char* field, std::size_t size, std::size_t bound) {
  if (defect_ || size <= bound) return;
  defect_ = path_ + field + " has " + std::to_string(size) + " entries, expected at most " +
            std::to_string(bound);
}

void BoundsCheck::value(const char* field, std::uint32_t value, std::uint32_t last) {
  if (defect_ || value <= last) return;
  defect_ =
      path_ + field + " is " + std::to_string(value) + ", expected 0 to " + std::to_string(last);
}

void BoundsCheck::key(const char* field, std::uint64_t key, std::string_view text) {
  if (defect_ || key == key_of(text)) return;
  defect_ = path_ + field + " does not match '" + std::string(text) + "'";
}

}  // namespace topogeo::messaging
