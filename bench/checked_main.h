#pragma once
// What benchmarks that verify their answers have in common: sizes and the main function.

#include <benchmark/benchmark.h>

#include <exception>
#include <iostream>

namespace exitance {

/// Arguments of a benchmark that times itself in furnished rooms of 500, 5,000 and 60,000 polygons.
inline void in_rooms_of_each_size(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("polygons")->Arg(500)->Arg(5000)->Arg(60000);
  benchmark->UseManualTime()->MinTime(1)->Unit(benchmark::kMillisecond);
}

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
