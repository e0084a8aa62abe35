#include "tests/places.h"

namespace exitance {

std::string program() {
  return EXITANCE_PROGRAM;
}

std::string source_file(const std::string& name) {
  return EXITANCE_SOURCE_DIR "/" + name;
}

}  // namespace exitance
