#pragma once
// The main function of benchmarks that verify their answers.

#include <benchmark/benchmark.h>

#include <exception>
#include <iostream>

namespace exitance {

/// Runs the benchmarks; 1 when one of them throws, because it found an answer wrong.
inline int run_benchmarks(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << "wrong answer: " << error.what() << '\n';
    return 1;
  }
  return 0;
}

}  // namespace exitance
