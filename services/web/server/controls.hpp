// Which page commands the robot. Pages of several operators take turns: one holds the controls, all
// see which, and another one asks for them or takes them over. Stop needs no controls.
//
// A page has a secret id, with which it shows that an order is its own, and a public number. The
// holder that is not connected any more holds nothing. Programs, which have no id, are not kept
// from ordering, because nobody is there to ask.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace topogeo::web {

/// Thread-safe.
class Controls {
 public:
  static constexpr std::size_t kLongestName = 40;  ///< bytes

  /// `show` gets each change of the channel `controls` as JSON. It is called under the lock.
  explicit Controls(std::function<void(std::string json)> show);

  /// A connection of a page; a page may have several. Returns the page's number; 0 for an empty id.
  std::uint32_t enter(std::uint64_t viewer, const std::string& id, const std::string& name);
  void leave(std::uint64_t viewer);
  void rename(const std::string& id, const std::string& name);

  /// Whether this page, or a program (empty id), may order. Free controls become those of the page.
  bool admit(const std::string& id);
  /// The same for an order through a connection.
  bool admit(std::uint64_t viewer);
  /// "Anna has the controls: ask for them, or take over"
  [[nodiscard]] std::string refusal() const;

  /// Asks the holder for the controls, or takes them if they are free.
  void ask(const std::string& id);
  /// The holder answers the page that asks.
  void answer(const std::string& id, bool give);
  /// The holder gives the controls up.
  void let_go(const std::string& id);
  /// Takes the controls over. Returns the connections of the page that had them.
  std::vector<std::uint64_t> take(const std::string& id);

  /// Shows who stopped the robot; empty: it is released.
  void set_stopped_by(const std::string& name);
  /// "Anna", or "a program".
  [[nodiscard]] std::string name_of(const std::string& id) const;
  /// The name of the page that has the controls; empty: they are free.
  [[nodiscard]] std::string holder() const;

 private:
  struct Page {
    std::uint32_t number = 0;
    std::string name;
    std::set<std::uint64_t> viewers{};
  };
  [[nodiscard]] bool is_free() const;
  bool admit_page(const std::string& id);
  void forget_old_pages();
  void show();

  mutable std::mutex mutex_;
  std::function<void(std::string json)> show_;
  std::map<std::string, Page> pages_;             // by id
  std::map<std::uint64_t, std::string> page_of_;  // of a viewer
  std::string holder_;                            // id; empty: never held
  std::string asking_;                            // id; empty: none
  std::string stopped_by_;
  std::uint32_t last_number_ = 0;
};

}  // namespace topogeo::web
