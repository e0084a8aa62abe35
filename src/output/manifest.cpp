#include "src/output/manifest.h"

#include <CGAL/version.h>
#include <OpenMesh/Core/System/config.h>
#include <embree3/rtcore_config.h>
#include <exitance_version.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <tbb/version.h>

#include <Eigen/Core>
#include <boost/version.hpp>

namespace exitance {

Manifest build_manifest() {
  Manifest manifest;
  manifest.version = kVersion;
  manifest.commit = kCommit;
  manifest.compiler = kCompiler;
  manifest.libraries = {
      {"CGAL", fmt::format("{}.{}.{}", CGAL_VERSION_MAJOR, CGAL_VERSION_MINOR, CGAL_VERSION_PATCH)},
      {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"Boost", fmt::format("{}.{}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
      {"OpenMesh",
       fmt::format("{}.{}.{}", (OM_VERSION & 0xf0000) >> 16, (OM_VERSION & 0x0ff00) >> 8, OM_VERSION & 0xff)},
      {"TBB", TBB_runtime_version()},
      {"HDF5", fmt::format("{}.{}.{}", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE)},
      {"Embree", RTC_VERSION_STRING}};
  return manifest;
}

std::string build_key() {
  return fmt::format("version {}\ncommit {}\ncompiler {}\n", kVersion, kCommit, kCompiler);
}

}  // namespace exitance
