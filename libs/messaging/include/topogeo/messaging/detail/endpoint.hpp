// Untyped base of Writer<T> and Reader<T>.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/topics.hpp"

namespace topogeo::messaging::detail {

class LoopAccess;

/// Common base of writers and readers: peers and events.
class Endpoint {
 public:
  Endpoint();
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;
  virtual ~Endpoint();

  [[nodiscard]] int matched() const;
  /// The readers or writers that are connected now.
  [[nodiscard]] std::vector<Handle> peers() const;
  /// Whether a peer belongs to the same program as the reader or writer `program`.
  [[nodiscard]] bool connected_with(const Handle& program) const;
  /// Name with prefix and version.
  [[nodiscard]] std::string_view topic() const;
  /// Messages written, or handed over to the program, since the endpoint was made.
  [[nodiscard]] std::uint64_t messages() const;
  bool wait_for_matched(int count, std::chrono::nanoseconds timeout) const;
  /// Hands over the events since the last call, oldest first, in this thread.
  virtual void take_events(const EventHandler& handler);
  /// `wake` is called from threads of the middleware whenever an event comes in.
  void set_wake(std::function<void()> wake);

  struct Shared;

 protected:
  std::shared_ptr<Shared> shared_;
};

class WriterCore final : public Endpoint {
 public:
  WriterCore(const Participant& participant, const TopicInfo& topic, const std::string& role);
  ~WriterCore() override;

  bool write(const void* message);
  void dispose(const void* message);
  bool wait_for_acknowledgments(std::chrono::nanoseconds timeout);
  /// Whole names of the topics that the program of `reader` announced to read as well.
  [[nodiscard]] std::vector<std::string> read_with(const Handle& reader) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class ReaderCore final : public Endpoint {
 public:
  using Handler = std::function<void(const void* message, const SampleInfo&)>;

  ReaderCore(const Participant& participant, const TopicInfo& topic, const std::string& role,
             const std::string& addressee, const std::vector<std::string_view>& read_with = {});
  ~ReaderCore() override;

  std::size_t take(std::size_t limit, const Handler& handler);
  bool wait_for_data(std::chrono::nanoseconds timeout);
  /// Samples that came and were not taken yet.
  [[nodiscard]] std::uint64_t waiting() const;
  void take_events(const EventHandler& handler) override;

 private:
  friend class LoopAccess;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace topogeo::messaging::detail
