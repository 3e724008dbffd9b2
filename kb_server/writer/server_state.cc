#include "kb_server/writer/server_state.h"

#include <array>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/base/archive.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/term_archive.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/engine/run_facts.h"

namespace docent::server {

template <class Archive>
void Fields(Archive& a, BatchOutcome& o) {
  a(o.offset, o.added, o.removed, o.inferred, o.started);
}

namespace {

// What this code writes and reads. Another number: another meaning of the bytes that follow.
constexpr uint64_t kStateFormat = 14;
constexpr uint64_t kOldestStateFormat = 4;  // that can be read
// About what they take there: where it is enough, the bytes need not move when they become more.
constexpr size_t kBytesATerm = 16;
constexpr size_t kBytesAQuad = 8;

absl::Status Damaged(const char* what) {
  return absl::DataLossError(absl::StrCat("the snapshot's ", what, " do not decode"));
}

void WriteTerms(const Dictionary& dictionary, uint64_t count, Pace* pace, ByteWriter* out) {
  out->Varint(count);
  for (uint64_t i = 0; i < count; ++i) {
    if (pace != nullptr) pace->Rest();
    const Dictionary::EntryView entry = dictionary.EntryAt(i);
    (*out)(entry.tag, entry.is_language, entry.qualifier);
    out->Text(entry.text);
  }
}

// The ids that the terms of a snapshot have in this dictionary.
class TermMap {
 public:
  bool Read(ByteReader* in, Dictionary* dictionary) {
    const size_t count = in->Count();
    ids_.reserve(count);
    for (size_t i = 0; i < count && in->ok(); ++i) {
      Dictionary::EntryView entry;
      (*in)(entry.tag, entry.is_language, entry.qualifier);
      entry.text = in->Text();
      const bool known_tag = entry.tag >= TermId::Tag::kIri && entry.tag <= TermId::Tag::kLiteral;
      if (!known_tag || entry.qualifier > i) return false;
      if (entry.qualifier > 0)
        entry.qualifier = static_cast<uint32_t>(ids_[entry.qualifier - 1].payload() + 1);
      ids_.push_back(dictionary->InternEntry(entry));
      same_ = same_ && ids_.back().payload() == i;
    }
    return in->ok();
  }
  // All terms have the ids that they had.
  bool same() const { return same_; }
  // The none id: there is no such term.
  TermId operator()(TermId id) const {
    if (!id.InDictionary()) return id;
    if (id.payload() >= ids_.size() || ids_[id.payload()].tag() != id.tag()) return TermId();
    return ids_[id.payload()];
  }

 private:
  std::vector<TermId> ids_;
  bool same_ = true;
};

using Words = std::array<uint64_t, 4>;

Words WordsOf(const Quad& quad) {
  return {quad.subject.bits(), quad.predicate.bits(), quad.object.bits(), quad.graph.bits()};
}

// Quads mostly share words with the one before: a byte says which differ, and by how much follows.
void WriteQuad(const Quad& quad, Words* before, ByteWriter* out) {
  const Words words = WordsOf(quad);
  uint64_t changed = 0;
  for (int i = 0; i < 4; ++i) changed |= uint64_t{words[i] != (*before)[i]} << i;
  out->Varint(changed);
  for (int i = 0; i < 4; ++i) {
    if (words[i] != (*before)[i]) out->Signed(static_cast<int64_t>(words[i] - (*before)[i]));
  }
  *before = words;
}

// nullopt: a term that is not there.
std::optional<Quad> ReadQuad(ByteReader* in, const TermMap& map, Words* before) {
  const uint64_t changed = in->Varint();
  for (int i = 0; i < 4; ++i) {
    if ((changed >> i & 1) != 0) (*before)[i] += static_cast<uint64_t>(in->Signed());
  }
  const Quad quad{map(TermId((*before)[0])), map(TermId((*before)[1])), map(TermId((*before)[2])),
                  map(TermId((*before)[3]))};
  const bool whole =
      !quad.subject.IsNone() && !quad.predicate.IsNone() && !quad.object.IsNone() && !quad.graph.IsNone();
  return in->ok() && whole ? std::optional(quad) : std::nullopt;
}

void WriteGraph(const GraphVersion& graph, Pace* pace, ByteWriter* out) {
  out->Varint(graph.size());
  Words before{};
  graph.ForEach({}, [&](const Quad& quad) {
    if (pace != nullptr) pace->Rest();
    WriteQuad(quad, &before, out);
    return true;
  });
}

bool ReadGraph(ByteReader* in, const TermMap& map, GraphWriter* writer) {
  const size_t count = in->Count();
  std::vector<Quad> quads;
  quads.reserve(count);
  Words before{};
  while (quads.size() < count) {
    const std::optional<Quad> quad = ReadQuad(in, map, &before);
    if (!quad) return false;
    quads.push_back(*quad);
  }
  writer->AddAll(std::move(quads));
  return true;
}

void WriteLifetimes(const std::vector<std::pair<TimeMicros, Quad>>& lifetimes, ByteWriter* out) {
  out->Varint(lifetimes.size());
  Words before{};
  for (const auto& [end_us, quad] : lifetimes) {
    out->Signed(end_us);
    WriteQuad(quad, &before, out);
  }
}

bool ReadLifetimes(ByteReader* in, const TermMap& map, BatchApplier* applier) {
  std::vector<std::pair<TimeMicros, Quad>> lifetimes;
  Words before{};
  for (size_t left = in->Count(); left > 0; --left) {
    const TimeMicros end_us = in->Signed();
    const std::optional<Quad> quad = ReadQuad(in, map, &before);
    if (!quad) return false;
    lifetimes.emplace_back(end_us, *quad);
  }
  applier->RestoreLifetimes(lifetimes);
  return true;
}

void WriteEvents(const EventShelf::Events& events, ByteWriter* out) {
  out->Varint(events.size());
  Words before{};
  for (const auto& [id, event] : events) {
    (*out)(id.bits(), event.told, event.waits, event.facts.size());
    for (const Quad& quad : event.facts) WriteQuad(quad, &before, out);
  }
}

bool ReadEvents(ByteReader* in, const TermMap& map, EventShelf::Events* events) {
  Words before{};
  for (size_t left = in->Count(); left > 0; --left) {
    uint64_t id = 0;
    size_t facts = 0;
    EventShelf::Event event;
    (*in)(id, event.told, event.waits, facts);
    for (; facts > 0; --facts) {
      const std::optional<Quad> quad = ReadQuad(in, map, &before);
      if (!quad) return false;
      event.facts.insert(*quad);
    }
    const TermId known = map(TermId(id));
    if (known.IsNone() || !in->ok()) return false;
    events->emplace(known, std::move(event));
  }
  return true;
}

constexpr uint64_t kNoFingerprint = 0;  // of a text; nothing reads it, but the format has it

void WriteDocuments(const std::map<Documents::Key, Documents::Entry>& documents, ByteWriter* out) {
  out->Varint(documents.size());
  for (const auto& [key, entry] : documents) {
    (*out)(key, entry.size, kNoFingerprint, entry.revision);
    out->Text(entry.text != nullptr ? *entry.text : "");
  }
}

bool ReadDocuments(ByteReader* in, std::map<Documents::Key, Documents::Entry>* documents) {
  for (size_t left = in->Count(); left > 0 && in->ok(); --left) {
    Documents::Key key;
    Documents::Entry entry;
    uint64_t fingerprint = 0;
    (*in)(key, entry.size, fingerprint, entry.revision);
    entry.text = std::make_shared<const std::string>(in->Text());
    (*documents)[key] = std::move(entry);
  }
  return in->ok();
}

// Since format 6.
void WriteVersions(const VersionHistory& versions, ByteWriter* out) {
  out->Varint(versions.all().size());
  for (const auto& [key, document] : versions.all()) {
    (*out)(key, document->live, document->removed);
    out->Varint(document->kept.size());
    for (const DocumentVersionPtr& version : document->kept) {
      (*out)(version->number, version->own_version, version->revision, version->time_us);
      out->Text(version->text);
    }
  }
}

bool ReadVersions(ByteReader* in, VersionHistory* versions) {
  for (size_t left = in->Count(); left > 0 && in->ok(); --left) {
    VersionHistory::Key key;
    DocumentVersions document;
    (*in)(key, document.live, document.removed);
    for (size_t texts = in->Count(); texts > 0 && in->ok(); --texts) {
      auto version = std::make_shared<DocumentVersion>();
      (*in)(version->number, version->own_version, version->revision, version->time_us);
      version->text = in->Text();
      document.kept.push_back(std::move(version));
    }
    if (document.kept.empty()) return false;
    versions->Restore(key, std::move(document));
  }
  return in->ok();
}

void WriteRequests(const std::vector<RememberedRequestPtr>& requests, ByteWriter* out) {
  out->Varint(requests.size());
  for (const RememberedRequestPtr& request : requests) (*out)(request->id, request->outcome);
}

// Since format 11 in a section of their own, one for each request.
void WriteDigests(const std::vector<RememberedRequestPtr>& requests, ByteWriter* out) {
  out->Varint(requests.size());
  for (const RememberedRequestPtr& request : requests) out->Varint(request->digest);
}

bool ReadDigests(ByteReader* in, std::vector<RememberedRequest>* requests) {
  if (in->Count() != requests->size()) return false;
  for (RememberedRequest& request : *requests) request.digest = in->Varint();
  return in->ok();
}

bool ReadRequests(ByteReader* in, std::vector<RememberedRequest>* requests) {
  for (size_t left = in->Count(); left > 0 && in->ok(); --left) {
    RememberedRequest& request = requests->emplace_back();
    (*in)(request.id, request.outcome);
  }
  return in->ok();
}

void WriteTimes(const std::vector<LastingSince>& times, ByteWriter* out) {
  out->Varint(times.size());
  for (const LastingSince& t : times) (*out)(t.handle, t.part, t.binding, t.since_us, t.full);
}

bool ReadTimes(ByteReader* in, std::vector<LastingSince>* times) {
  for (size_t left = in->Count(); left > 0 && in->ok(); --left) {
    LastingSince& t = times->emplace_back();
    (*in)(t.handle, t.part, t.binding, t.since_us, t.full);
  }
  return in->ok();
}

// The facts of the graph docent:runs by the run that they are about: "urn:docent:run:R" and what lies below
// it.
class RunFactsOfGraph {
 public:
  RunFactsOfGraph(const Dictionary& dictionary, const GraphVersion& graph) : graph_(graph) {
    const std::optional<TermId> runs = dictionary.FindIri(kRunsGraph);
    const std::optional<TermId> type = dictionary.FindIri(kRdfType);
    const std::optional<TermId> run = dictionary.FindIri(DocentIri("Run"));
    if (!runs || !type || !run) return;
    runs_ = *runs;
    absl::flat_hash_set<std::string_view> names;
    graph.ForEach({{}, *type, *run, *runs}, [&](const Quad& quad) {
      names.insert(dictionary.Lexical(quad.subject));
      return true;
    });
    TermId last;
    graph.ForEach({{}, {}, {}, *runs}, [&](const Quad& quad) {
      if (quad.subject == last) return true;
      last = quad.subject;
      std::string_view name = dictionary.Lexical(quad.subject);
      while (!names.contains(name)) {
        const size_t slash = name.rfind('/');
        if (slash == std::string_view::npos) return true;
        name = name.substr(0, slash);
      }
      subjects_[name].push_back(quad.subject);
      return true;
    });
  }

  std::vector<Quad> operator()(const RunId& run) const {
    std::vector<Quad> facts;
    const auto it = subjects_.find(RunIri(run));
    if (it == subjects_.end()) return facts;
    for (const TermId subject : it->second) {
      graph_.ForEach({subject, {}, {}, runs_}, [&facts](const Quad& quad) {
        facts.push_back(quad);
        return true;
      });
    }
    return facts;
  }

 private:
  const GraphVersion& graph_;
  TermId runs_;
  absl::flat_hash_map<std::string_view, std::vector<TermId>> subjects_;
};

absl::Status RestoreEngine(std::string_view bytes, const std::vector<LastingSince>& times, TimeMicros time_us,
                           const Limits& limits, Stages* stages) {
  const GraphVersion& graph = stages->writer.current();
  const RunFactsOfGraph facts(stages->dictionary, graph);
  absl::StatusOr<engine::EngineState> engine = engine::DecodeEngineState(
      bytes, limits, &stages->dictionary, [&facts](const RunId& run) { return facts(run); });
  if (!engine.ok()) return engine.status();
  const std::vector<engine::ConditionRequest> conditions = engine::ArmedConditions(*engine);
  stages->engine.Restore(*std::move(engine));
  return stages->conditions.Restore(conditions, times, graph, time_us);
}

}  // namespace

ServerState TakeState(const Stages& stages, const RequestMemory& requests, GraphVersionPtr graph,
                      TimeMicros time_us) {
  ServerState state;
  state.offset = graph->revision().value();
  state.time_us = time_us;
  state.graph = std::move(graph);
  state.terms = stages.dictionary.size();
  state.lifetimes = stages.applier.Lifetimes();
  state.events = stages.events.events();
  state.documents = stages.documents.entries();
  state.versions = stages.documents.versions();
  state.engine = stages.engine.Save();
  state.times = stages.conditions.Times();
  state.requests = requests.All();
  return state;
}

absl::StatusOr<std::string> EncodeState(const ServerState& state, const Dictionary& dictionary, Pace* pace) {
  const absl::StatusOr<std::string> engine = engine::EncodeEngineState(state.engine);
  if (!engine.ok()) return engine.status();
  ByteWriter out;
  out.Reserve(state.terms * kBytesATerm + state.graph->size() * kBytesAQuad);
  out(kStateFormat, std::string(kEngineVersion), state.offset, state.time_us);
  WriteTerms(dictionary, state.terms, pace, &out);
  WriteGraph(*state.graph, pace, &out);
  WriteLifetimes(state.lifetimes, &out);
  WriteDocuments(state.documents, &out);
  out.Text(*engine);
  WriteTimes(state.times, &out);
  WriteRequests(state.requests, &out);
  WriteEvents(state.events, &out);
  WriteVersions(state.versions, &out);
  WriteDigests(state.requests, &out);
  return out.Take();
}

absl::StatusOr<RestoredState> DecodeState(std::string_view bytes, Dictionary* dictionary,
                                          const sparql::FunctionRegistry* functions, const Limits& limits) {
  ByteReader in(bytes);
  uint64_t format = 0;
  in(format);
  if (format < kOldestStateFormat || format > kStateFormat) {
    return absl::FailedPreconditionError(absl::StrCat("the snapshot has the format ", format,
                                                      "; this version reads ", kOldestStateFormat, " to ",
                                                      kStateFormat));
  }
  RestoredState restored;
  std::string engine_version;
  in(engine_version, restored.offset, restored.time_us);
  restored.stages = std::make_unique<Stages>(dictionary, functions, limits);
  Stages& stages = *restored.stages;
  TermMap map;
  if (!map.Read(&in, dictionary)) return Damaged("terms");
  if (!ReadGraph(&in, map, &stages.writer)) return Damaged("quads");
  if (!ReadLifetimes(&in, map, &stages.applier)) return Damaged("lifetimes");
  std::map<Documents::Key, Documents::Entry> documents;
  if (!ReadDocuments(&in, &documents)) return Damaged("documents");
  const std::string_view engine = in.Text();
  std::vector<LastingSince> times;
  if (!ReadTimes(&in, &times)) return Damaged("times of conditions");
  std::vector<RememberedRequest> requests;
  if (!ReadRequests(&in, &requests)) return Damaged("request ids");
  EventShelf::Events events;
  if (format >= 6 && !ReadEvents(&in, map, &events)) return Damaged("events");
  VersionHistory versions;
  if (format >= 7 && !ReadVersions(&in, &versions)) return Damaged("versions of documents");
  if (format >= 11 && !ReadDigests(&in, &requests)) return Damaged("digests of requests");
  if (!in.AtEnd()) return Damaged("end");
  for (RememberedRequest& request : requests)
    restored.requests.push_back(std::make_shared<const RememberedRequest>(std::move(request)));
  if (format >= 6) stages.events.Restore(std::move(events), restored.time_us);
  // Before format 6 no event left, before format 13 none that a run told.
  if (format < 13) stages.events.Adopt(stages.writer.current(), restored.time_us);

  absl::Status status = stages.documents.Restore(std::move(documents), &stages.rules);
  if (!status.ok()) return status;
  // Another engine may infer otherwise: it computes anew with its first turn.
  if (engine_version == kEngineVersion) stages.rules.Adopt();
  status = RestoreEngine(engine, times, restored.time_us, limits, &stages);
  if (!status.ok()) return status;
  stages.documents.RestoreVersions(std::move(versions), stages.engine);
  stages.Commit();
  stages.writer.Freeze(Revision(restored.offset));
  return restored;
}

}  // namespace docent::server
