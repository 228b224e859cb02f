# find_package(topogeo): topogeo::messaging (topics, writers, readers, event loop) and topogeo::idl (types).
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
find_dependency(fmt)
find_dependency(spdlog)
find_dependency(yaml-cpp)
find_dependency(fastcdr)
find_dependency(fastrtps)
include(${CMAKE_CURRENT_LIST_DIR}/topogeo-targets.cmake)
