#pragma once
// Memory of this process and of the machine it runs on.

#include <cstdint>

namespace exitance {

/// Most memory this process has held so far [bytes].
std::uint64_t peak_memory_bytes();

/// Memory that this process may still take without the system swapping [bytes]: what Linux calls available, or less
/// where a control group allows less. 2^64 − 1 where the system does not say.
std::uint64_t available_memory_bytes();

}  // namespace exitance
