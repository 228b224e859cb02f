// Which programs are connected with everything that they read of this one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "topogeo/messaging/writer.hpp"

namespace topogeo::messaging {

/// Each reader of a program is connected at a time of its own, and what is sent on a volatile topic
/// before that is lost. A reader announces what its program reads as well
/// (ReaderOptions::read_with). The program is connected when its readers of all of those topics are
/// that are written here.
class ConnectedPrograms {
 public:
  /// Programs that read the topic of `counted`; `others` are the other writers of this program.
  template <class T, class... Others>
  explicit ConnectedPrograms(const Writer<T>& counted, const Writer<Others>&... others)
      : counted_(counted.core()), others_{others.core()...} {}

  template <class T>
  void include(const Writer<T>& other) {
    others_.push_back(other.core());
  }

  [[nodiscard]] int count() const;
  /// The topics that some programs are not connected with, for people: "odometry".
  [[nodiscard]] std::string missing() const;

 private:
  [[nodiscard]] std::vector<std::string> missing_of(const Handle& reader) const;

  std::shared_ptr<detail::WriterCore> counted_;
  std::vector<std::shared_ptr<detail::WriterCore>> others_;
};

}  // namespace topogeo::messaging
