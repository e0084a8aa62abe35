#pragma once
// What every experiment can be asked for: to write its tables, to be small, to be checked.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "experiments/csv_table.h"

namespace exitance {

class ExperimentOptions {
 public:
  /// Adds the options: where what goes (`written`), what is left of it (`smaller`), what is compared (`checked`).
  ExperimentOptions(CLI::App& app, const std::string& written, const std::string& smaller, const std::string& checked) {
    app.add_option("-o,--output", out_, "Folder for " + written)->each([](const std::string& folder) {
      std::error_code failed;
      std::filesystem::create_directories(folder, failed);
      if (!failed) return;
      fmt::print(stderr, "{}: cannot be a folder ({}); name one that is or can be made\n", folder, failed.message());
      throw CLI::RuntimeError(3);
    });
    app.add_flag("--reduced", reduced_, smaller);
    app.add_option("--check", expected_, checked);
  }

  ExperimentOptions(const ExperimentOptions&) = delete;  // the app writes to it
  ExperimentOptions& operator=(const ExperimentOptions&) = delete;

  bool reduced() const { return reduced_; }

  /// Whether tables and plots are wanted, and the folder for them, which is there.
  bool writes() const { return !out_.empty(); }
  std::filesystem::path folder() const { return out_; }

  /// The exit code: what is wrong with the run, by the table that is expected, is printed. wrong(expected): lines.
  template <class Wrong>
  int check(const Wrong& wrong) const {
    return expected_.empty() ? 0 : verdict(wrong(CsvTable::read(expected_)));
  }
  /// The same by `differences` of a table.
  int check(const CsvTable& table, std::size_t keys, double tolerance, const std::vector<std::string>& ignored) const {
    return check([&](const CsvTable& expected) { return differences(table, expected, keys, tolerance, ignored); });
  }

 private:
  std::string out_, expected_;
  bool reduced_ = false;
};

}  // namespace exitance
