#pragma once
// Bad input: one clear line that says where, what is wrong and how to mend it.

#include <cstddef>
#include <stdexcept>
#include <string>

namespace exitance {

/// Thrown by readers. what() is "file:line: what; how to mend" (the line is left out where there is none).
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, std::size_t line, const std::string& what);
};

/// Thrown when something would not fit or a limit was reached; the program ends with exit code 4.
class LimitError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace exitance
