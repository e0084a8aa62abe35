#pragma once
// What a stress run is told to people and programs.

#include <map>
#include <string>
#include <vector>

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
/// {"cases": [...]}: each failure, and after it the forms of it that a property compares it with; those of areas as
/// polygon_polygon. `truth` beside the question is what the oracle says, where that is a number.
std::string failures_as_cases(const StressReport& report);

}  // namespace exitance
