# The libraries of Debian 12 that the modules are built on (design: a well-kept library outside of the core).
# OpenMesh by its config before CGAL: CGAL ships a find module of the same name that fails.
find_package(PkgConfig REQUIRED)
find_package(OpenMesh CONFIG REQUIRED)
list(APPEND CMAKE_MODULE_PATH /usr/share/cmake/geographiclib)
find_package(GeographicLib REQUIRED)
find_package(CGAL REQUIRED)
find_package(PCL REQUIRED COMPONENTS common kdtree search filters features segmentation sample_consensus surface
                                     registration QUIET)
find_package(embree 3 REQUIRED)
pkg_check_modules(FLANN REQUIRED IMPORTED_TARGET flann liblz4)
pkg_check_modules(GSL REQUIRED IMPORTED_TARGET gsl)
pkg_check_modules(NETTLE REQUIRED IMPORTED_TARGET nettle)
pkg_check_modules(JANSSON REQUIRED IMPORTED_TARGET jansson)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)

set(PLANTIMETER_IO_LIBRARIES OpenMeshCore ${GeographicLib_LIBRARIES} PkgConfig::JANSSON PkgConfig::NETTLE m)
set(PLANTIMETER_SEGMENT_LIBRARIES PkgConfig::GSL m)
set(PLANTIMETER_MESH_LIBRARIES CGAL::CGAL OpenMeshCore OpenMeshTools PkgConfig::GSL m)
set(PLANTIMETER_SIMULATE_LIBRARIES embree PkgConfig::GSL PkgConfig::JANSSON PNG::PNG m)
set(PLANTIMETER_TRAITS_LIBRARIES PkgConfig::GSL m)
set(PLANTIMETER_REPORTS_LIBRARIES PkgConfig::JANSSON PkgConfig::GSL PNG::PNG JPEG::JPEG m)
