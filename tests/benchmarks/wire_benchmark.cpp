/// How fast documents are written: bytes of the document a second on one core, into a sink that drops them.
/// Not covered: the network.

#include <random>

#include <benchmark/benchmark.h>

#include "api/document/gzip.hpp"
#include "api/result/result_document.hpp"

namespace signorini::api {
namespace {

constexpr Eigen::Index triangles = 5'000'000;

/// A body whose stress has 15 million numbers with all their digits; nothing else counts.
const Solution& large_solution() {
  static const Solution solution = [] {
    Solution large;
    large.components = 2;
    std::mt19937_64 random(1);
    std::normal_distribution<double> stress(0, 1e6);
    large.stress_at_centroids = Eigen::MatrixXd::NullaryExpr(
        3, triangles, [&](Eigen::Index, Eigen::Index) { return stress(random); });
    return large;
  }();
  return solution;
}

/// Counts the bytes and drops them.
class Drop {
 public:
  Sink sink() {
    return [this](std::string_view piece) {
      benchmark::DoNotOptimize(piece.data());
      bytes_ += static_cast<std::int64_t>(piece.size());
      return true;
    };
  }
  std::int64_t bytes() const { return bytes_; }

 private:
  std::int64_t bytes_ = 0;
};

bool write_stress_field(Format format, const Sink& sink) {
  return write_document(format, sink, [](DocumentWriter& out) {
    write_result(out, {"", "succeeded", "{}"}, large_solution(), ResultFields::parse("stress"));
  });
}

void WriteField(benchmark::State& state, Format format) {
  large_solution();
  Drop drop;
  for (auto _ : state) write_stress_field(format, drop.sink());
  state.SetBytesProcessed(drop.bytes());
}

/// The bytes are those before compression.
void WriteFieldCompressed(benchmark::State& state, Format format) {
  large_solution();
  Drop drop;
  std::int64_t bytes = 0;
  for (auto _ : state) {
    const Sink sink = drop.sink();
    Gzip gzip(sink);
    write_stress_field(format, [&](std::string_view piece) {
      bytes += static_cast<std::int64_t>(piece.size());
      return gzip.put(piece);
    });
    gzip.finish();
  }
  state.SetBytesProcessed(bytes);
  state.counters["ratio"] = static_cast<double>(bytes) / static_cast<double>(drop.bytes());
}

BENCHMARK_CAPTURE(WriteField, json, Format::json)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WriteField, cbor, Format::cbor)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WriteFieldCompressed, json, Format::json)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(WriteFieldCompressed, cbor, Format::cbor)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace signorini::api
