// Meaningless payloads within the wire contract of a type: numbers that are NaN or beyond all
// limits, texts and sequences that are empty or of full length, stamps of other centuries.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/random.hpp"

#include "idl_schema.hpp"

namespace topogeo::test {

/// Fixed contents of a stranger's sample; the rest is absurd.
struct AbsurdStyle {
  std::string robot_id = "robot";
  /// Texts of fields by their names, for example to address a peer.
  std::map<std::string, std::string> texts = {};
  /// Enumerators by type and field, as "Goal.kind".
  std::map<std::string, std::uint32_t> enumerators = {};
  /// True: no floating-point number is finite and no sequence is empty, so that each message with
  /// such a number must be refused.
  bool not_finite = true;
  /// Sequences and texts as long as their bounds and kMostBytes allow.
  bool full = false;
};

/// The XCDR1 encoding, little-endian (Object Management Group, DDSI-RTPS 2.2, chapter 10), of a
/// message made up from the IDL.
class AbsurdPayload {
 public:
  AbsurdPayload(const IdlSchema& schema, support::Random& random, AbsurdStyle style)
      : schema_(schema), random_(random), style_(std::move(style)) {}

  std::string make(const std::string& type) {
    bytes_.assign("\0\1\0\0", kHeader_bytes);
    add_struct(type);
    return bytes_;
  }

 private:
  static constexpr std::size_t kHeader_bytes = 4;
  /// Below 64 KiB, so that a sample is not fragmented.
  static constexpr std::size_t kMostBytes = 48'000;

  void add_struct(const std::string& type) {
    std::map<std::string, std::string> texts;  // texts so far, for keys
    for (const IdlMember& member : schema_.members(type)) {
      const auto given = style_.enumerators.find(type + "." + member.name);
      if (given != style_.enumerators.end()) {
        add_number(given->second);
      } else if (member.name == "schema_version") {
        add_number<std::uint32_t>(static_cast<std::uint32_t>(schema_.constant("kSchemaVersion")));
      } else if (member.type.starts_with("string<")) {
        const std::string text = text_of(member);
        add_text(texts[member.name] = text);
      } else if (const auto key = key_of(member.name, texts)) {
        add_number<std::uint64_t>(*key);
      } else {
        add_value(member.type);
      }
    }
  }

  static std::optional<std::uint64_t> key_of(const std::string& name,
                                             const std::map<std::string, std::string>& texts) {
    if (!name.ends_with("_key")) return std::nullopt;
    const std::string text = name.substr(0, name.size() - 4);
    for (const std::string& field : {text, text + "_id"}) {
      if (const auto found = texts.find(field); found != texts.end()) {
        return messaging::key_of(found->second);
      }
    }
    return std::nullopt;
  }

  void add_value(const std::string& type) {
    static const std::regex sequence(R"(sequence<([^,]+), *(\w+)>)");
    if (std::smatch found; std::regex_match(type, found, sequence)) {
      add_sequence(found[1], schema_.constant(found[2]));
    } else if (schema_.is_struct(type)) {
      add_struct(type);
    } else if (const std::size_t size = schema_.array_size(type)) {
      for (std::size_t i = 0; i < size; ++i) add_number(real<double>());
    } else if (const std::size_t values = schema_.enumerators(type)) {
      add_number(static_cast<std::uint32_t>(random_.below(values)));
    } else {
      add_plain(type);
    }
  }

  void add_plain(const std::string& type) {
    if (type == "double") {
      add_number(real<double>());
    } else if (type == "float") {
      add_number(real<float>());
    } else if (type == "boolean") {
      add_number(static_cast<std::uint8_t>(random_.below(2)));
    } else if (type == "octet") {
      add_number(integer<std::uint8_t>());
    } else if (type == "unsigned short" || type == "short") {
      add_number(integer<std::uint16_t>());
    } else if (type == "unsigned long" || type == "long") {
      add_number(integer<std::uint32_t>());
    } else if (type == "unsigned long long" || type == "long long") {
      add_number(integer<std::uint64_t>());
    } else {
      throw std::invalid_argument("unknown type of the IDL: " + type);
    }
  }

  void add_sequence(const std::string& type, std::uint64_t bound) {
    const std::size_t at = add_number<std::uint32_t>(0);
    std::uint64_t least = style_.not_finite ? 1 : random_.below(3);
    if (style_.full) least = bound;
    std::uint32_t size = 0;
    for (; size < least && (size == 0 || bytes_.size() < kMostBytes); ++size) add_value(type);
    std::memcpy(&bytes_[at], &size, sizeof size);
  }

  std::string text_of(const IdlMember& member) {
    if (member.name == "robot_id") return style_.robot_id;
    if (const auto given = style_.texts.find(member.name); given != style_.texts.end()) {
      return given->second;
    }
    const std::size_t bound = std::stoul(member.type.substr(std::strlen("string<")));
    switch (style_.full ? 0 : random_.below(4)) {
      case 0:
        return std::string(bound, '\xff');  // not UTF-8
      case 1:
        return "stranger";
      case 2:
        return std::string("/../%s\n\x1b[2J\"'<script>").substr(0, bound);
      default:
        return {};
    }
  }

  void add_text(const std::string& text) {
    add_number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.append(text).push_back('\0');
  }

  template <class Real>
  Real real() {
    using Limits = std::numeric_limits<Real>;
    constexpr std::array<Real, 3> kNone = {Limits::quiet_NaN(), Limits::infinity(),
                                           -Limits::infinity()};
    constexpr std::array<Real, 6> kHuge = {
        Limits::max(),        -Limits::max(),           static_cast<Real>(1e30),
        Limits::denorm_min(), static_cast<Real>(-1e30), Limits::quiet_NaN()};
    return style_.not_finite ? kNone.at(random_.below(kNone.size()))
                             : kHuge.at(random_.below(kHuge.size()));
  }

  template <class Unsigned>
  Unsigned integer() {
    constexpr auto kAllOnes = std::numeric_limits<Unsigned>::max();
    constexpr auto kHighest = static_cast<Unsigned>(kAllOnes / 2);
    // Signed values: -1 and close to it, the largest, the smallest, the year 2250 in ns.
    constexpr std::uint64_t kYear2250_ns = 8'830'000'000'000'000'000;
    switch (random_.below(6)) {
      case 0:
        return kHighest;
      case 1:
        return static_cast<Unsigned>(kHighest + 1);
      case 2:
        return static_cast<Unsigned>(kAllOnes - random_.below(8));
      case 3:
        return static_cast<Unsigned>(kYear2250_ns);
      case 4:
        return static_cast<Unsigned>(random_.below(3));
      default:
        return kAllOnes;
    }
  }

  /// Returns the position of its first byte.
  template <class Number>
  std::size_t add_number(Number value) {
    while ((bytes_.size() - kHeader_bytes) % sizeof value != 0) bytes_.push_back('\0');
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(&bytes_[at], &value, sizeof value);
    return at;
  }

  const IdlSchema& schema_;
  support::Random& random_;
  AbsurdStyle style_;
  std::string bytes_;
};

}  // namespace topogeo::test
