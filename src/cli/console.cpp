#include "src/cli/console.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <utility>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

/// Length of the UTF-8 character at the start of the text, which is not empty; 0 if it is none or controls a terminal.
std::size_t shown_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xc2 && first < 0xe0 ? 2
                             : (first & 0xf0) == 0xe0      ? 3
                             : (first & 0xf8) == 0xf0      ? 4
                                                           : 0;
  if (length == 0 || text.size() < length) return 0;
  std::uint32_t code = first & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fu);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return overlong || surrogate || code > 0x10ffff || code < 0xa0 ? 0 : length;  // below 0xa0: C1 controls
}

/// A line as it is or, where it is longer than kLongest bytes, with an ellipsis for its middle: names in it may be of
/// any length, what stands at its start tells where something is wrong, and what stands at its end how to mend it.
std::string shortened(std::string line) {
  constexpr std::size_t kLongest = 1000, kAtEnd = 400;
  if (line.size() <= kLongest) return line;
  const auto continues = [&](std::size_t at) { return (static_cast<std::uint8_t>(line[at]) & 0xc0) == 0x80; };
  std::size_t from = kLongest - kAtEnd, to = line.size() - kAtEnd;
  while (continues(from)) --from;
  while (continues(to)) ++to;
  return line.replace(from, to - from, "…");
}

void print_line(std::string_view before, std::string_view text) {
  std::string line = printable(text);
  std::ranges::replace(line, '\n', ' ');
  fmt::print(stderr, "{}{}\n", before, shortened(std::move(line)));
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = text[0] == '\n' ? 1 : shown_character(text);
    if (length > 0) {
      shown += text.substr(0, length);
    } else {
      shown += fmt::format("\\x{:02x}", static_cast<std::uint8_t>(text[0]));
    }
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  return shown;
}

void print_results(std::string_view text) {
  errno = 0;
  std::cout << text << std::flush;
  if (!std::cout) {
    throw InputError("standard output", 0,
                     fmt::format("cannot be written ({}); the results are incomplete",
                                 errno != 0 ? std::strerror(errno) : "it failed earlier"));
  }
}

void print_message(std::string_view text) {
  print_line("exitance: ", text);
}

void print_warning(std::string_view text) {
  print_line("warning: ", text);
}

}  // namespace exitance
