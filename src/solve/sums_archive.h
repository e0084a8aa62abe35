#pragma once
// Running sums in archives, both of their parts: what is taken up again goes on to the same bits.

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "src/output/archive.h"
#include "src/solve/compensated.h"

namespace exitance {

/// As `name` and `name`_low.
void write_sums(ArchiveWriter& file, const std::string& name, std::span<const CompensatedSum> sums);
/// Throws DamagedFile.
std::vector<CompensatedSum> sums_in(const ArchiveReader& file, const std::string& name);

/// Puts what was found in place of as many values. Throws DamagedFile where they are not as many.
template <class Value>
void take(const ArchiveReader& file, std::vector<Value> found, std::vector<Value>& values) {
  if (found.size() != values.size()) file.refuse("it is of another mesh");
  values = std::move(found);
}

}  // namespace exitance
