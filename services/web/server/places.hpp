// The places of connections. When none is free, the address with the most places loses the one that
// was silent longest: newcomers are heard, and one address cannot shut out others.
#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <utility>

namespace topogeo::web {

class Places {
 public:
  /// A connection that may hold a place.
  class Guest {
   public:
    explicit Guest(std::string address) : address_(std::move(address)) {}
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    [[nodiscard]] const std::string& address() const { return address_; }

   protected:
    ~Guest() = default;

   private:
    friend class Places;
    /// Its place was taken: the guest must end soon.
    virtual void give_way() = 0;

    std::string address_;
    Places* held_ = nullptr;
    std::list<Guest*>::iterator place_;
  };

  explicit Places(std::size_t most) : most_(most) {}
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;
  ~Places() = default;

  /// Takes a place, and releases the guest's place elsewhere. False when another guest had to go.
  bool enter(Guest& guest);
  /// Records that the guest was heard; does nothing without a place.
  static void touch(Guest& guest);
  /// Does nothing without a place.
  static void leave(Guest& guest);
  [[nodiscard]] std::size_t size() const { return guests_.size(); }

 private:
  Guest& dispensable() const;

  std::size_t most_;
  std::list<Guest*> guests_;  // the one silent longest first
};

}  // namespace topogeo::web
