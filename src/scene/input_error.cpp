#include "src/scene/input_error.h"

namespace exitance {
namespace {

std::string place(const std::string& file, std::size_t line) {
  std::string text = file;
  if (line > 0) text.append(":").append(std::to_string(line));
  return text;
}

}  // namespace

InputError::InputError(const std::string& file, std::size_t line, const std::string& what)
    : std::runtime_error(place(file, line).append(": ").append(what)) {}

}  // namespace exitance
