#include "src/cli/given_options.h"

namespace exitance {

std::map<std::string, std::string> given_options(const CLI::App& verb) {
  std::map<std::string, std::string> given;
  for (const CLI::Option* option : verb.get_options()) {
    if (option == verb.get_help_ptr()) continue;
    given[option->get_single_name()] =
        option->count() > 0 ? CLI::detail::join(option->results(), " ") : option->get_default_str();
  }
  return given;
}

}  // namespace exitance
