#pragma once
// How much memory is asked for at once.

#include <cstddef>

namespace exitance {

/// Of this program's operator new, since it was set to 0; of any thread.
std::size_t largest_memory_request();
void forget_memory_requests();

}  // namespace exitance
