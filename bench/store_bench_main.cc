// How fast the store is: bulk of one transaction, one-triple versions, scans, lookups, and memory a triple.
// Baseline in the same run: std::set over the same keys, the simplest ordered index.
#include <benchmark/benchmark.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/store/graph_writer.h"

namespace docent {
namespace {

TermId Iri(uint64_t n) {
  return TermId::Make(TermId::Tag::kIri, n);
}

// Random triples in one graph: a subject of n/10, one of 50 predicates, an object of n/2.
std::vector<Quad> RandomQuads(size_t n) {
  std::mt19937_64 random(7);
  std::vector<Quad> quads;
  for (size_t i = 0; i < n; ++i) {
    quads.push_back({Iri(100 + random() % (n / 10)), Iri(random() % 50),
                     Iri(100 + n / 10 + random() % (n / 2)), Iri(99)});
  }
  return quads;
}

const GraphVersionPtr& Loaded(size_t n) {
  static std::map<size_t, GraphVersionPtr> versions;
  GraphVersionPtr& version = versions[n];
  if (version == nullptr) {
    GraphWriter writer(nullptr);
    for (const Quad& quad : RandomQuads(n)) writer.Add(quad);
    version = writer.Freeze(Revision(1));
  }
  return version;
}

void BM_InsertOneTransaction(benchmark::State& state) {
  std::vector<Quad> quads = RandomQuads(static_cast<size_t>(state.range(0)));
  for (auto _ : state) {
    GraphWriter writer(nullptr);
    for (const Quad& quad : quads) writer.Add(quad);
    GraphVersionPtr version = writer.Freeze(Revision(1));
    state.counters["bytes_per_triple"] =
        static_cast<double>(version->bytes()) / static_cast<double>(version->size());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_InsertOneTransaction)->Arg(2000000)->Unit(benchmark::kMillisecond)->Iterations(1);

void BM_InsertStdSet(benchmark::State& state) {
  std::vector<Quad> quads = RandomQuads(static_cast<size_t>(state.range(0)));
  for (auto _ : state) {
    std::set<Quad> set;
    for (const Quad& quad : quads) set.insert(quad);
    benchmark::DoNotOptimize(set.size());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_InsertStdSet)->Arg(2000000)->Unit(benchmark::kMillisecond)->Iterations(1);

void BM_BulkLoad(benchmark::State& state) {
  std::vector<Quad> quads = RandomQuads(static_cast<size_t>(state.range(0)));
  for (auto _ : state) {
    GraphWriter writer(nullptr);
    writer.AddAll(quads);
    GraphVersionPtr version = writer.Freeze(Revision(1));
    state.counters["bytes_per_triple"] =
        static_cast<double>(version->bytes()) / static_cast<double>(version->size());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_BulkLoad)->Arg(2000000)->Unit(benchmark::kMillisecond)->Iterations(1);

// A version for each triple, the one before dropped: what a stream of single facts costs.
void BM_OneTripleVersions(benchmark::State& state) {
  GraphVersionPtr version = Loaded(static_cast<size_t>(state.range(0)));
  GraphWriter writer(version);
  std::mt19937_64 random(11);
  uint64_t revision = 1;
  for (auto _ : state) {
    Quad quad{Iri(100 + random() % 200000), Iri(random() % 50), Iri(random() % 1000000), Iri(99)};
    if (!writer.Add(quad)) writer.Remove(quad);
    version = writer.Freeze(Revision(++revision));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_OneTripleVersions)->Arg(100000)->Arg(2000000);

// The pose of a robot: two values replaced in each version.
void BM_StateVersions(benchmark::State& state) {
  GraphVersionPtr version = Loaded(static_cast<size_t>(state.range(0)));
  GraphWriter writer(version);
  auto pose = [](uint64_t n) {
    return Quad{Iri(5), Iri(6), TermId::Make(TermId::Tag::kDecimal, n << 5 | 3), Iri(98)};
  };
  uint64_t n = 0;
  writer.Add(pose(0));
  for (auto _ : state) {
    writer.Apply({pose(n + 1)}, {pose(n)});
    version = writer.Freeze(Revision(++n));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_StateVersions)->Arg(100000);

void BM_FullScan(benchmark::State& state) {
  const GraphVersionPtr& version = Loaded(2000000);
  for (auto _ : state) {
    uint64_t sum = 0;
    for (QuadCursor c = version->ScanInOrder({}, static_cast<IndexOrder>(state.range(0))); c.Valid();
         c.Next()) {
      sum += c.quad().object.bits();
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(version->size()));
}
BENCHMARK(BM_FullScan)->DenseRange(0, kIndexOrders - 1)->Unit(benchmark::kMillisecond);

void BM_SubjectLookup(benchmark::State& state) {
  const GraphVersionPtr& version = Loaded(2000000);
  std::mt19937_64 random(3);
  int64_t found = 0;
  for (auto _ : state) {
    QuadPattern pattern{Iri(100 + random() % 200000), Iri(random() % 50), {}, {}};
    version->ForEach(pattern, [&](const Quad&) { return ++found != 0; });
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_SubjectLookup);

void BM_Count(benchmark::State& state) {
  const GraphVersionPtr& version = Loaded(2000000);
  std::mt19937_64 random(3);
  for (auto _ : state) {
    benchmark::DoNotOptimize(version->Count({{}, Iri(random() % 50), {}, {}}));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_Count);

void BM_InternIri(benchmark::State& state) {
  std::vector<std::string> iris;
  for (int64_t i = 0; i < 1000000; ++i)
    iris.push_back("http://example.org/things/" + std::to_string(i * 7919 % 1000000));
  for (auto _ : state) {
    Dictionary dictionary;
    for (const std::string& iri : iris) dictionary.InternIri(iri);
    state.counters["bytes_per_term"] =
        static_cast<double>(dictionary.bytes()) / static_cast<double>(dictionary.size());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(iris.size()));
}
BENCHMARK(BM_InternIri)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace docent

BENCHMARK_MAIN();
