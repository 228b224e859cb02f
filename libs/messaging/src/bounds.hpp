// Checks that the generated code leaves out: schema version, bounds of sequences, values of
// enumerations, keys that represent texts. cmake/idl_bounds.py finds the fields in the IDL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "topogeo/msg/bounds.h"

namespace topogeo::messaging {

using Defect = std::optional<std::string>;

/// Schema version of a message whose bytes could not be read.
inline constexpr std::uint32_t kUnreadable = 0xFFFFFFFF;

/// Keeps the first defect that the visit of a message finds.
class BoundsCheck {
 public:
  void schema(std::uint32_t version);
  void size(const char* field, std::size_t size, std::size_t bound);
  /// Checks an enumeration, which a peer may have filled with any number.
  void value(const char* field, std::uint32_t value, std::uint32_t last);
  /// Checks the number that represents a text in the key of the topic.
  template <class BoundedString>
  void key(const char* field, std::uint64_t key, const BoundedString& text) {
    this->key(field, key, std::string_view(text.c_str(), text.size()));
  }
  void key(const char* field, std::uint64_t key, std::string_view text);
  /// Runs the checks of `body` on members of `field`.
  template <class Body>
  void inside(const char* field, const Body& body) {
    const std::size_t outside = path_.size();
    path_.append(field).append(".");
    body();
    path_.resize(outside);
  }

  [[nodiscard]] const Defect& defect() const { return defect_; }

 private:
  std::string path_;  // of the struct whose fields are checked, for example "nodes."
  Defect defect_;
};

/// The reason why a message must not travel; empty when it may.
template <class Message>
Defect find_defect(const Message& message) {
  BoundsCheck check;
  msg::visit_bounds(message, check);
  return check.defect();
}

}  // namespace topogeo::messaging
