// The program: one verb a file.

#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"exitance: radiosity with exact visibility"};
  app.require_subcommand(0);
  CLI11_PARSE(app, argc, argv);
  return 0;
}
