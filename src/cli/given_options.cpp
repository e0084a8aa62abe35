#include "src/cli/given_options.h"

#include <algorithm>

#include "src/output/manifest.h"

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

std::string key_of_options(const CLI::App& verb, std::span<const std::string_view> of_no_consequence) {
  std::string key = build_key();
  for (const auto& [name, value] : given_options(verb)) {
    if (std::ranges::find(of_no_consequence, name) == of_no_consequence.end()) key += name + " " + value + "\n";
  }
  return key;
}

}  // namespace exitance
