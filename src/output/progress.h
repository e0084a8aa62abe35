#pragma once
// How far a long piece of work has come.

#include <functional>
#include <string_view>

namespace exitance {

/// Called now and then by long work, always from the thread that started it: the fraction done, in [0, 1] and never
/// falling, and what is being done ("form factors"). May be empty. What it throws ends the work and reaches its caller.
using Progress = std::function<void(double fraction, std::string_view label)>;

}  // namespace exitance
