// The program: one verb a file.

#include <CLI/CLI.hpp>
#include <new>
#include <stdexcept>

#include "src/cli/cases.h"
#include "src/cli/console.h"
#include "src/cli/verbs.h"
#include "src/output/manifest.h"
#include "src/scene/input_error.h"
#include "src/solve/radiosity_system.h"

namespace {

using namespace exitance;

int refuse(ExitCode code, std::string_view message) {
  print_message(message);
  return code;
}

/// Parses, which runs the verb; --help and --version are answered here.
void parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("a verb");
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    print_results("");
  }
}

int run(CLI::App& app, int argc, char** argv) {
  try {
    parse(app, argc, argv);
    return done;
  } catch (const CLI::RuntimeError& ended) {
    return ended.get_exit_code();
  } catch (const CLI::ParseError& wrong) {
    return refuse(usage, std::string(wrong.what()) + "; see exitance --help and exitance VERB --help");
  } catch (const InputError& wrong) {
    return refuse(bad_input, wrong.what());
  } catch (const LimitError& reached) {
    return refuse(limit_reached, reached.what());
  } catch (const std::bad_alloc&) {
    return refuse(limit_reached, "out of memory");
  } catch (const InvalidSystem& failed) {
    return refuse(check_failed, failed.what());
  } catch (const std::invalid_argument& wrong) {
    return refuse(usage, wrong.what());
  } catch (const std::exception& failed) {
    return refuse(check_failed, failed.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"exitance: radiosity with exact visibility", "exitance"};
  app.set_version_flag("--version", build_manifest().version);
  app.require_subcommand(0, 1);
  app.footer(
      "Exit codes: 0 done; 1 a numerical check failed; 2 usage; 3 bad input; 4 a limit was reached.\n"
      "Results go to stdout or to -o, progress and messages to stderr.");
  add_cases(app);
  add_check(app);
  add_compare(app);
  add_diff(app);
  add_dynamic(app);
  add_formfactor(app);
  add_generate(app);
  add_reference(app);
  add_solve(app);
  add_stress(app);
  return run(app, argc, argv);
}
