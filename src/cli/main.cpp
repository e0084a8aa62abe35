// The program: one verb a file.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "src/cli/cases.h"
#include "src/scene/input_error.h"

int main(int argc, char** argv) {
  CLI::App app{"exitance: radiosity with exact visibility"};
  app.require_subcommand(1);
  exitance::add_cases(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& ended) {
    return ended.get_exit_code();
  } catch (const CLI::ParseError& wrong) {
    return app.exit(wrong) == 0 ? 0 : 2;
  } catch (const exitance::InputError& wrong) {
    fmt::print(stderr, "exitance: {}\n", wrong.what());
    return 3;
  }
  return 0;
}
