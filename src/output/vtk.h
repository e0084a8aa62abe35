#pragma once
// VTK PolyData in XML (.vtp), for ParaView.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "src/output/faces.h"

namespace exitance {

/// Values of the elements. Every number must be finite.
struct VtkArray {
  std::string name;                     ///< as in "B"
  std::string unit;                     ///< as in "W/m^2"; empty for a plain number
  std::vector<std::string> components;  ///< their names; empty for a single one
  std::span<const double> values;       ///< elements × components
};

/// One polygon a face with cell data: what is given, of its element, and `element`, `patch` and `surface`, counted from
/// 0. Written as text with the fewest digits that give the same doubles back; units stand in the arrays' UNITS_LABEL.
/// Throws InputError when the file cannot be written, std::invalid_argument when a number is not finite (VTK could not
/// read it).
void write_vtp(const std::filesystem::path& path, const Faces& faces, std::span<const VtkArray> arrays);

}  // namespace exitance
