// Update half of the grammar: SPARQL 1.1 productions [29] to [52].
#include <utility>

#include "graph/sparql/syntax/grammar.h"

namespace docent::sparql {

using Kind = UpdateOperation::Kind;

std::optional<Update> Grammar::UpdateUnit() {
  Update update;
  while (Prologue() && Peek().kind != TokenKind::kEnd && CountOperation()) {
    BeginCounts();
    UpdateOperation operation;
    operation.span = Peek().span;
    ++operation_;
    blank_bgp_.clear();
    if (Update1(&operation)) {
      update.operations.push_back(std::move(operation));
    } else {
      RecoverAtSemicolon();
    }
    if (Accept(";")) continue;
    if (Peek().kind != TokenKind::kEnd) {
      Expected("';' before the next operation, or the end of the update");
      RecoverAtSemicolon();
      if (!Accept(";")) break;
    }
  }
  if (failed()) return std::nullopt;
  update.base_iri = std::move(base_iri_);  // parsing is done
  update.prefixes = std::move(prefixes_);
  return update;
}

void Grammar::RecoverAtSemicolon() {
  for (int open = 0; Peek().kind != TokenKind::kEnd; Take()) {
    if (At("{")) ++open;
    if (At("}")) --open;
    if (At(";") && open <= 0) return;
  }
}

bool Grammar::Update1(UpdateOperation* operation) {
  if (AtWord("INSERT") && AtWord("DATA", 1)) {
    operation->kind = Kind::kInsertData;
    Take();
    Take();
    return Quads(&operation->insert, QuadsUse::kInsertData);
  }
  if (AtWord("DELETE") && AtWord("DATA", 1)) {
    operation->kind = Kind::kDeleteData;
    Take();
    Take();
    return Quads(&operation->remove, QuadsUse::kDeleteData);
  }
  if (AtWord("DELETE") && AtWord("WHERE", 1)) return DeleteWhere(operation);
  if (AtWord("INSERT") || AtWord("DELETE") || AtWord("WITH")) return Modify(operation);
  if (AtWord("LOAD")) return Load(operation);
  for (const auto& [word, kind] :
       {std::pair{Keyword("CLEAR"), Kind::kClear}, {Keyword("DROP"), Kind::kDrop}}) {
    if (!AcceptWord(word)) continue;
    operation->kind = kind;
    operation->silent = AcceptWord("SILENT");
    return GraphRefAll(&operation->target);
  }
  if (AcceptWord("CREATE")) {
    operation->kind = Kind::kCreate;
    operation->silent = AcceptWord("SILENT");
    return GraphRef(&operation->target);
  }
  for (const auto& [word, kind] : {std::pair{Keyword("COPY"), Kind::kCopy},
                                   {Keyword("MOVE"), Kind::kMove},
                                   {Keyword("ADD"), Kind::kAdd}}) {
    if (!AcceptWord(word)) continue;
    operation->kind = kind;
    operation->silent = AcceptWord("SILENT");
    return GraphOrDefault(&operation->source) && ExpectWord("TO", "and a graph") &&
           GraphOrDefault(&operation->target);
  }
  const bool query = AtWord("SELECT") || AtWord("ASK") || AtWord("CONSTRUCT") || AtWord("DESCRIBE");
  Expected("INSERT, DELETE, WITH, LOAD, CLEAR, DROP, CREATE, COPY, MOVE or ADD",
           query ? "this is a query, not an update" : "");
  return false;
}

bool Grammar::Load(UpdateOperation* operation) {
  operation->kind = Kind::kLoad;
  Take();
  operation->silent = AcceptWord("SILENT");
  std::optional<Term> document = Iri();
  if (!document) return false;
  operation->document = *std::move(document);
  return !AcceptWord("INTO") || GraphRef(&operation->target);
}

bool Grammar::GraphRef(GraphTarget* target) {
  if (!ExpectWord("GRAPH", "and an IRI")) return false;
  std::optional<Term> graph = Iri();
  if (!graph) return false;
  *target = {GraphTarget::Kind::kGraph, *std::move(graph)};
  return true;
}

bool Grammar::GraphRefAll(GraphTarget* target) {
  if (AcceptWord("DEFAULT")) {
    target->kind = GraphTarget::Kind::kDefault;
  } else if (AcceptWord("NAMED")) {
    target->kind = GraphTarget::Kind::kNamed;
  } else if (AcceptWord("ALL")) {
    target->kind = GraphTarget::Kind::kAll;
  } else if (AtWord("GRAPH")) {
    return GraphRef(target);
  } else {
    Expected("GRAPH <iri>, DEFAULT, NAMED or ALL");
    return false;
  }
  return true;
}

bool Grammar::GraphOrDefault(GraphTarget* target) {
  if (AcceptWord("DEFAULT")) {
    target->kind = GraphTarget::Kind::kDefault;
    return true;
  }
  AcceptWord("GRAPH");
  std::optional<Term> graph = Iri();
  if (!graph) return false;
  *target = {GraphTarget::Kind::kGraph, *std::move(graph)};
  return true;
}

bool Grammar::Modify(UpdateOperation* operation) {
  operation->kind = Kind::kModify;
  if (AcceptWord("WITH")) {
    operation->with = Iri();
    if (!operation->with) return false;
  }
  const bool removes = AcceptWord("DELETE");
  if (removes && !Quads(&operation->remove, QuadsUse::kDeleteTemplate)) return false;
  const bool inserts = AcceptWord("INSERT");
  if (inserts && !Quads(&operation->insert, QuadsUse::kInsertTemplate)) return false;
  if (!removes && !inserts) {
    Expected("DELETE { … } or INSERT { … }");
    return false;
  }
  while (AcceptWord("USING")) {
    const bool named = AcceptWord("NAMED");
    std::optional<Term> graph = Iri();
    if (!graph || !Charge(2 * sizeof(Term))) return false;
    (named ? operation->from_named : operation->from).push_back(*std::move(graph));
  }
  if (!ExpectWord("WHERE", removes ? "after the templates (or DELETE WHERE { … })" : "after INSERT { … }")) {
    return false;
  }
  operation->where = GroupGraphPattern();
  return operation->where != nullptr;
}

// DELETE WHERE { quads }: the quads are pattern and template in one.
bool Grammar::DeleteWhere(UpdateOperation* operation) {
  operation->kind = Kind::kModify;
  Take();
  Take();
  const SourceSpan span = Peek().span;
  if (!Quads(&operation->remove, QuadsUse::kDeleteWhere)) return false;
  auto join = NewAlgebra(Algebra::Kind::kJoin, span);
  const QuadTemplate* before = nullptr;
  for (const QuadTemplate& quad : operation->remove) {
    if (!CountPattern() || !Charge(2 * sizeof(TriplePattern) + TextMemory(quad.triple))) return false;
    const bool same_graph =
        before != nullptr &&
        (before->graph == quad.graph || (before->graph && quad.graph && *before->graph == *quad.graph));
    if (!same_graph) {
      auto bgp = NewAlgebra(Algebra::Kind::kBgp, span);
      if (quad.graph) {
        auto graph = NewAlgebra(Algebra::Kind::kGraph, span);
        ChargeCopy(*quad.graph);
        graph->name = *quad.graph;
        graph->children.push_back(std::move(bgp));
        bgp = std::move(graph);
      }
      join->children.push_back(std::move(bgp));
    }
    Algebra* last = join->children.back().get();
    if (quad.graph) last = last->children[0].get();
    last->triples.push_back(quad.triple);
    before = &quad;
  }
  if (join->children.empty()) {
    operation->where = NewAlgebra(Algebra::Kind::kBgp, span);
  } else if (join->children.size() == 1) {
    operation->where = std::move(join->children[0]);
  } else {
    operation->where = std::move(join);
  }
  return true;
}

// '{' Quads '}', with the restrictions of each use (notes 6 to 9 of section 19.8, and 10 on labels).
bool Grammar::Quads(QuadTemplates* out, QuadsUse use) {
  if (!Expect("{", "before triples")) return false;
  bool ok = true;
  while (!At("}") && Peek().kind != TokenKind::kEnd) {
    if (AcceptWord("GRAPH")) {
      std::optional<PatternTerm> graph = VarOrIri();
      if (!graph || !Expect("{", "after the graph")) return false;
      if (!QuadTerm(*graph, use)) ok = false;
      Charge(sizeof(PatternTerm) + kBytesOfAllocation);
      if (!Triples(std::make_shared<const PatternTerm>(*std::move(graph)), out, use)) ok = false;
      if (!Expect("}", "after the triples of the graph")) return false;
      Accept(".");
    } else if (!Triples(nullptr, out, use)) {
      ok = false;
    }
  }
  return Expect("}", "after the triples") && ok;
}

// Triples up to '}' or GRAPH.
bool Grammar::Triples(std::shared_ptr<const PatternTerm> graph, QuadTemplates* out, QuadsUse use) {
  TriplesSink sink;
  sink.template_mode = true;
  sink.quads = out;
  sink.graph = std::move(graph);
  sink.use = use;
  bool ok = true;
  while (!At("}") && !AtWord("GRAPH") && Peek().kind != TokenKind::kEnd) {
    if (!TriplesSameSubject(&sink)) {
      ok = false;
      RecoverInGroup();
    } else if (!Accept(".") && !At("}") && !AtWord("GRAPH")) {
      Expected("'.' between triples, or '}'");
      ok = false;
      RecoverInGroup();
    }
    TakeQuads(&sink);
  }
  return ok && sink.ok;
}

void Grammar::TakeQuads(TriplesSink* sink) {
  for (TriplePattern& t : sink->triples) {
    for (const PatternTerm* term : {&t.subject, &t.predicate, &t.object}) {
      if (!QuadTerm(*term, sink->use)) sink->ok = false;
    }
    sink->quads->push_back({std::move(t), sink->graph});
  }
  sink->triples.clear();
}

bool Grammar::QuadTerm(const PatternTerm& term, QuadsUse use) {
  const bool data = use == QuadsUse::kInsertData || use == QuadsUse::kDeleteData;
  const bool inserts = use == QuadsUse::kInsertData || use == QuadsUse::kInsertTemplate;
  if (term.IsVariable()) {
    if (!data) return true;
    Error(term.span, "?" + term.variable().name + " is a variable, which DATA cannot hold",
          inserts ? "write INSERT { … } WHERE { … }" : "write DELETE WHERE { … }");
    return false;
  }
  if (!term.term().IsBlank()) return true;
  if (!inserts) {
    Error(term.span, "a blank node cannot be deleted by its label: it would be a new one",
          "use a variable: DELETE { ?x … } WHERE { ?x … }");
    return false;
  }
  if (use != QuadsUse::kInsertData) return true;
  const auto [it, added] = data_labels_.emplace(term.term().lexical, operation_);
  if (added) Charge(sizeof(*it) + kBytesOfChild + TextMemory(it->first));
  if (added || it->second == operation_) return true;
  Error(term.span, "_:" + term.term().lexical + " was used in another INSERT DATA of this request",
        "a label means something within one operation only; join the two, or use another label");
  return false;
}

}  // namespace docent::sparql
