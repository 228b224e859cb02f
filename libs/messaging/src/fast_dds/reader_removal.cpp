// In Fast DDS 2.9.1 StatefulWriter::matched_reader_remove calls check_acked_status while it holds
// the locators of the writer. That function takes messages out of the history, for which it waits
// for the flow controller. The thread of the flow controller holds itself while it sends and waits
// for the locators: neither goes on.
//
// Here the messages are taken out after the locators are released. The functions take the place of
// the library's, which calls them through their symbols. Should a library have no such functions,
// nothing calls these.
#include "reader_removal.hpp"

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/writer/StatefulWriter.h>

#include "library_function.hpp"

namespace rtps = eprosima::fastrtps::rtps;

// NOLINTBEGIN: the names of member functions of the library
extern "C" void topogeo_check_acknowledged(rtps::StatefulWriter* writer) __asm__(
    "_ZN8eprosima8fastrtps4rtps14StatefulWriter18check_acked_statusEv");
extern "C" bool
topogeo_remove_reader(rtps::StatefulWriter* writer, const rtps::GUID_t& reader) __asm__(
    "_ZN8eprosima8fastrtps4rtps14StatefulWriter21matched_reader_removeERKNS1_6GUID_tE");
// NOLINTEND

namespace {

/// A writer from which this thread is removing a reader.
thread_local rtps::StatefulWriter* reader_leaves = nullptr;
thread_local bool check_is_due = false;

}  // namespace

extern "C" void topogeo_check_acknowledged(rtps::StatefulWriter* writer) {
  static const auto original =
      topogeo::messaging::library_function<void (*)(rtps::StatefulWriter*)>(
          "_ZN8eprosima8fastrtps4rtps14StatefulWriter18check_acked_statusEv");
  if (writer == reader_leaves) {
    check_is_due = true;
    return;
  }
  original(writer);
}

extern "C" bool topogeo_remove_reader(rtps::StatefulWriter* writer, const rtps::GUID_t& reader) {
  static const auto original =
      topogeo::messaging::library_function<bool (*)(rtps::StatefulWriter*, const rtps::GUID_t&)>(
          "_ZN8eprosima8fastrtps4rtps14StatefulWriter21matched_reader_removeERKNS1_6GUID_tE");
  reader_leaves = writer;
  check_is_due = false;
  const bool removed = original(writer, reader);
  reader_leaves = nullptr;
  if (check_is_due) topogeo_check_acknowledged(writer);
  return removed;
}

namespace topogeo::messaging {

void let_readers_leave_beside_sending() {}

}  // namespace topogeo::messaging
