#pragma once
// What the program says: results on standard output, everything else on standard error.

#include <string>
#include <string_view>

namespace exitance {

/// Text that may hold anything, for a terminal: control characters other than line feeds, and bytes that are not UTF-8,
/// become \xNN.
std::string printable(std::string_view text);

/// Writes all of it to standard output, after what std::cout still holds. Throws InputError when that fails (a full
/// disk), so that results cannot get lost unnoticed.
void print_results(std::string_view text);

/// One printable line on standard error, whatever is in the text; of a long one its start and its end.
void print_message(std::string_view text);  ///< "exitance: text"
void print_warning(std::string_view text);  ///< "warning: text"

}  // namespace exitance
