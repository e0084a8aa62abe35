#pragma once
// What a stress run is told to people and programs.

#include <filesystem>
#include <map>
#include <string>

#include "src/stress/stress_run.h"

namespace exitance {

struct StressSummary {
  const StressReport& report;
  std::vector<std::string> contenders;  ///< in the order asked for
  std::uint64_t seed = 1;
  std::map<std::string, std::string> options;  ///< as given

  StressTally total() const;  ///< of all contenders
};

std::string to_json(const StressSummary& summary);
std::string in_words(const StressSummary& summary);
/// A row a family, departure and contender.
std::string to_csv(const StressSummary& summary);
/// {"cases": [...]}: each failure, and after it the forms of it that a property compares it with. `truth` beside the
/// question is what the oracle says.
std::string failures_as_cases(const StressReport& report);
/// Worst errors, with the numbers of wrong answers and broken properties printed on them.
void write_stress_map(const std::filesystem::path& path, const StressSummary& summary);

}  // namespace exitance
