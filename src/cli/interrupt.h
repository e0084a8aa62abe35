#pragma once
// Ctrl-C as a wish to end early.

namespace exitance {

/// From now on the first SIGINT or SIGTERM only sets a flag; a second one ends the program as usual.
void catch_interrupts();

/// Any thread may ask.
bool interrupted();

}  // namespace exitance
