#include "topogeo/search_pool/client_registry.hpp"

#include <algorithm>

namespace topogeo::search_pool {

template <class Condition>
std::vector<ClientRegistry::Entry> ClientRegistry::take(Condition condition) {
  std::vector<Entry> taken;
  for (auto it = clients_.begin(); it != clients_.end();) {
    if (condition(it->second)) {
      taken.emplace_back(it->first, std::move(it->second));
      it = clients_.erase(it);
    } else {
      ++it;
    }
  }
  return taken;
}

bool ClientRegistry::task_came(const std::string& client_id, const std::string& robot_id,
                               const ProcessId& participant, Time now) {
  const auto [found, is_new] = clients_.try_emplace(client_id);
  Client& client = found->second;
  client.robot_id = robot_id;
  client.participant = participant;
  client.last_task = now;
  if (is_new) ++ever_;
  return is_new;
}

const ClientRegistry::Client* ClientRegistry::find(const std::string& client_id) const {
  const auto found = clients_.find(client_id);
  return found == clients_.end() ? nullptr : &found->second;
}

void ClientRegistry::answered(const std::string& client_id) {
  const auto found = clients_.find(client_id);
  if (found != clients_.end()) ++found->second.answered;
}

void ClientRegistry::reader_came(const ProcessId& participant) {
  ++readers_[participant];
}

std::vector<ClientRegistry::Entry> ClientRegistry::reader_gone(const ProcessId& participant) {
  const auto found = readers_.find(participant);
  if (found == readers_.end() || --found->second > 0) return {};
  readers_.erase(found);
  return take([&](const Client& client) { return client.participant == participant; });
}

std::vector<ClientRegistry::Entry> ClientRegistry::take_silent(Time before) {
  return take([&](const Client& client) {
    return !is_connected(client.participant) && client.last_task < before;
  });
}

std::size_t ClientRegistry::active(Time since) const {
  return static_cast<std::size_t>(
      std::count_if(clients_.begin(), clients_.end(),
                    [&](const auto& entry) { return entry.second.last_task >= since; }));
}

}  // namespace topogeo::search_pool
