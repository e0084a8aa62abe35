#pragma once
// Work that is dropped in its middle.

#include <functional>
#include <stdexcept>

namespace exitance {

/// Asked now and then while something is worked on: whether it is to throw Abandoned. None: never.
using Abandon = std::function<bool()>;

/// Thrown where work is not to go on and nothing of it is to stay.
class Abandoned : public std::runtime_error {
 public:
  Abandoned() : std::runtime_error("the work was abandoned") {}
};

/// Throws Abandoned where that is asked for.
inline void go_on(const Abandon& abandon) {
  if (abandon && abandon()) throw Abandoned();
}

}  // namespace exitance
