// R-trees of points and boxes in a plane (Boost.Geometry). Boost 1.83 declares the comparisons of
// an R-tree in a header of their own, which 1.74 does not have.
#pragma once

#include <boost/geometry/algorithms/comparable_distance.hpp>
#include <boost/geometry/algorithms/covered_by.hpp>
#include <boost/geometry/algorithms/disjoint.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#if __has_include(<boost/geometry/strategies/index/cartesian.hpp>)
#include <boost/geometry/strategies/index/cartesian.hpp>
#endif
#include <boost/geometry/index/rtree.hpp>
