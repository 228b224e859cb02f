# Finds Fast DDS: 3 (Debian 13) or 2.9.1 (Debian 12, under its earlier name fastrtps), for exactly which
# libs/messaging/src/fast_dds is made. Sets TOPOGEO_FAST_DDS_MAJOR, TOPOGEO_FAST_DDS (its package and
# target), TOPOGEO_FAST_DDS_DEFINITIONS (for all that includes its headers), and TOPOGEO_FASTDDSGEN_MAJOR, the version
# of the generator that belongs to it.

find_package(fastcdr REQUIRED)
find_package(fastdds 3 QUIET)
if(fastdds_FOUND)
  set(TOPOGEO_FAST_DDS_MAJOR 3)
  set(TOPOGEO_FAST_DDS fastdds)
  # Debian's library has security, but its headers do not define this, which decides the order of virtual functions.
  set(TOPOGEO_FAST_DDS_DEFINITIONS HAVE_SECURITY=1)
  # It links this, which defines _FILE_OFFSET_BITS for its users: no change on a 64-bit system, but GCC then refuses the
  # precompiled headers.
  set_property(TARGET tinyxml2::tinyxml2 PROPERTY INTERFACE_COMPILE_DEFINITIONS "")
  set(TOPOGEO_FASTDDSGEN_MAJOR 4)
else()
  find_package(fastrtps 2.9.1 EXACT REQUIRED)
  set(TOPOGEO_FAST_DDS_MAJOR 2)
  set(TOPOGEO_FAST_DDS fastrtps)
  set(TOPOGEO_FAST_DDS_DEFINITIONS "")
  set(TOPOGEO_FASTDDSGEN_MAJOR 2)
endif()
