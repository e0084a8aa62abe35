#include "src/solve/sums_archive.h"

namespace exitance {

void write_sums(ArchiveWriter& file, const std::string& name, std::span<const CompensatedSum> sums) {
  std::vector<double> high, low;
  for (const CompensatedSum& sum : sums) {
    high.push_back(sum.high());
    low.push_back(sum.low());
  }
  file.write(name, std::span<const double>(high));
  file.write(name + "_low", std::span<const double>(low));
}

std::vector<CompensatedSum> sums_in(const ArchiveReader& file, const std::string& name) {
  const std::vector<double> high = file.doubles(name), low = file.doubles(name + "_low");
  if (high.size() != low.size()) file.refuse("its vectors do not fit each other");
  std::vector<CompensatedSum> sums;
  for (std::size_t k = 0; k < high.size(); ++k) sums.emplace_back(high[k], low[k]);
  return sums;
}

}  // namespace exitance
