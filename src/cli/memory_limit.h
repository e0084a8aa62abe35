#pragma once
// How much memory a verb may take.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

namespace exitance {

class MemoryLimit {
 public:
  /// Adds --memory-limit. The object must live as long as the verb.
  void add_to(CLI::App& verb);

  /// What was given, or what is available now.
  std::uint64_t bytes() const;

 private:
  std::optional<double> GiB_;
};

/// In MiB or GiB.
std::string size_in_words(std::uint64_t bytes);

/// Throws LimitError where the form factors of so many patches would take more memory than may be used [bytes].
void refuse_what_does_not_fit(std::size_t patches, std::uint64_t needed, std::uint64_t available);

}  // namespace exitance
