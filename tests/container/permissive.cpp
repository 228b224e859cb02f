// Makes a program ignore its own permissions when preloaded: Fast DDS lets it create writers and
// readers of all topics, like a modified program. Its peers still decide what they accept.
extern "C" bool create_any_writer() __asm__(
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datawriterERKNS2_6HandleEjRK"
    "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_"
    "17SecurityExceptionE");
extern "C" bool create_any_reader() __asm__(
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_create_datareaderERKNS2_6HandleEjRK"
    "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKSt6vectorISC_SaISC_EERNS2_"
    "17SecurityExceptionE");

extern "C" bool create_any_writer() {
  return true;
}

extern "C" bool create_any_reader() {
  return true;
}
