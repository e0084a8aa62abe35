#pragma once
// What a plot was made with.

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <thread>

#include "src/output/manifest.h"

namespace exitance {

/// Processor and its cores, program, compiler and libraries.
inline std::string plot_note() {
  std::string processor = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    processor = line.substr(line.find(':') + 2);
    break;
  }
  const Manifest build = build_manifest();
  return fmt::format("{}, {} cores; exitance {} ({}), {}, Embree {}, CGAL {}", processor,
                     std::thread::hardware_concurrency(), build.version, build.commit.substr(0, 7), build.compiler,
                     build.libraries.at("Embree"), build.libraries.at("CGAL"));
}

}  // namespace exitance
