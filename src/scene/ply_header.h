#pragma once
// The header of a PLY file: which numbers follow, in which order and type.

#include <optional>
#include <string>
#include <vector>

#include "src/scene/text_cursor.h"

namespace exitance {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { text, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
};

/// Reads up to and including "end_header"; the cursor then stands in that line. Throws InputError for anything else.
PlyHeader read_ply_header(TextCursor& text);

}  // namespace exitance
