#include "topogeo/messaging/discovery.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <string_view>
#include <tuple>

#include <fnmatch.h>

namespace topogeo::messaging {

namespace {

/// A partition may be a pattern; no partition is the same as one without a name.
bool meet(const RemoteEndpoint& a, const RemoteEndpoint& b) {
  const std::vector<std::string> unnamed = {""};
  const auto& names_a = a.partitions.empty() ? unnamed : a.partitions;
  const auto& names_b = b.partitions.empty() ? unnamed : b.partitions;
  for (const std::string& name_a : names_a) {
    for (const std::string& name_b : names_b) {
      if (name_a == name_b || ::fnmatch(name_a.c_str(), name_b.c_str(), 0) == 0 ||
          ::fnmatch(name_b.c_str(), name_a.c_str(), 0) == 0) {
        return true;
      }
    }
  }
  return false;
}

/// A writer must not offer a longer time than the reader requests; 0 means no limit.
bool too_long(double offered_s, double requested_s) {
  return requested_s > 0.0 && (offered_s == 0.0 || offered_s > requested_s);
}

std::vector<std::string> differences(const RemoteEndpoint& writer, const RemoteEndpoint& reader) {
  const OfferedQos& offered = writer.qos;
  const OfferedQos& requested = reader.qos;
  std::vector<std::string> found;
  if (writer.type != reader.type) found.emplace_back("type");
  if (requested.reliable && !offered.reliable) found.emplace_back("reliability");
  if (offered.durability < requested.durability) found.emplace_back("durability");
  if (too_long(offered.deadline_s, requested.deadline_s)) found.emplace_back("deadline");
  if (offered.liveliness < requested.liveliness || too_long(offered.lease_s, requested.lease_s)) {
    found.emplace_back("liveliness");
  }
  if (offered.exclusive != requested.exclusive) found.emplace_back("ownership");
  return found;
}

}  // namespace

std::vector<Mismatch> find_mismatches(std::span<const RemoteEndpoint> endpoints) {
  std::vector<Mismatch> found;
  std::set<std::tuple<std::string, std::string, std::string, std::string>> known;
  for (const RemoteEndpoint& writer : endpoints) {
    if (!writer.writer) continue;
    for (const RemoteEndpoint& reader : endpoints) {
      if (reader.writer || reader.topic != writer.topic || !meet(writer, reader)) continue;
      for (std::string& what : differences(writer, reader)) {
        if (!known.emplace(writer.topic, writer.participant, reader.participant, what).second) {
          continue;
        }
        found.push_back({writer, reader, std::move(what)});
      }
    }
  }
  return found;
}

std::uint32_t wire_version(const std::string& topic) {
  constexpr std::string_view kPrefix = "topogeo/v";
  const std::string_view name = topic;
  if (!name.starts_with(kPrefix)) return 0;
  std::uint32_t version = 0;
  const char* const end = name.data() + name.size();
  const auto [after, error] = std::from_chars(name.data() + kPrefix.size(), end, version);
  return error == std::errc() && after != end && *after == '/' ? version : 0;
}

}  // namespace topogeo::messaging
