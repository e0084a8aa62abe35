#pragma once
// How much memory is asked for at once, and how much is kept.

#include <cstddef>

namespace exitance {

/// Of this program's operator new, since it was set to 0; of any thread.
std::size_t largest_memory_request();
void forget_memory_requests();

/// Bytes that this process has and has not freed, those of C libraries as well; 0 where the allocator doesn't tell.
std::size_t memory_held();

}  // namespace exitance
