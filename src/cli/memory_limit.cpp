#include "src/cli/memory_limit.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/cli/number_range.h"
#include "src/output/process_memory.h"
#include "src/scene/input_error.h"

namespace exitance {

void MemoryLimit::add_to(CLI::App& verb) {
  verb.add_option("--memory-limit", GiB_, "Memory for form factors [GiB]; all that is available unless given")
      ->check(positive_number());
}

std::uint64_t MemoryLimit::bytes() const {
  return GiB_ ? static_cast<std::uint64_t>(std::min(*GiB_ * 0x1p30, 0x1p63)) : available_memory_bytes();
}

std::string size_in_words(std::uint64_t bytes) {
  const double MiB = static_cast<double>(bytes) * 0x1p-20;
  return MiB < 1024 ? fmt::format("{:.3g} MiB", MiB) : fmt::format("{:.3g} GiB", MiB / 1024);
}

void refuse_what_does_not_fit(std::size_t patches, std::uint64_t needed, std::uint64_t available) {
  if (needed <= available) return;
  throw LimitError(
      fmt::format("the form factors of {} patches would take about {} of memory and {} may be used; larger patches "
                  "need less",
                  patches, size_in_words(needed), size_in_words(available)));
}

}  // namespace exitance
