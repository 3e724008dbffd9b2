#include "reasoner/conditions/condition_template.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"

namespace docent::conditions {
namespace {

using sparql::Algebra;
using sparql::PatternTerm;

// A probe gives up when it finds more than this many solutions beyond twice the number of members.
constexpr size_t kSpareSolutions = 64;

// Equal constants become the same variable.
void OpenTerm(PatternTerm& term, TemplateForm& form) {
  if (term.IsVariable()) return;
  const auto known = std::find(form.constants.begin(), form.constants.end(), term.term());
  const auto place = static_cast<size_t>(known - form.constants.begin());
  if (known == form.constants.end()) {
    form.constants.push_back(term.term());
    // no query has a variable with a space in its name
    form.parameters.push_back(absl::StrCat("constant ", place));
  }
  term = PatternTerm::Of(sparql::Variable{form.parameters[place]});
}

// Inside EXISTS, a constant that also occurs outside becomes the same variable.
void OpenKnown(PatternTerm& term, const absl::flat_hash_set<std::string>& scope, const TemplateForm& form) {
  if (term.IsVariable()) return;
  const auto known = std::find(form.constants.begin(), form.constants.end(), term.term());
  if (known == form.constants.end()) return;
  const std::string& name = form.parameters[static_cast<size_t>(known - form.constants.begin())];
  if (scope.contains(name)) term = PatternTerm::Of(sparql::Variable{name});
}

void OpenKnown(Algebra& node, const absl::flat_hash_set<std::string>& scope, const TemplateForm& form) {
  const bool plain = node.kind == Algebra::Kind::kBgp || node.kind == Algebra::Kind::kJoin;
  if (!plain) return;
  for (sparql::TriplePattern& triple : node.triples) {
    OpenKnown(triple.subject, scope, form);
    const bool type = !triple.predicate.IsVariable() && triple.predicate.term().lexical == kRdfType;
    if (!type) OpenKnown(triple.object, scope, form);
  }
  for (const auto& child : node.children) OpenKnown(*child, scope, form);
}

void OpenKnown(sparql::Expression& expression, const absl::flat_hash_set<std::string>& scope,
               const TemplateForm& form) {
  if (expression.pattern) OpenKnown(*expression.pattern, scope, form);
  for (const auto& argument : expression.arguments) OpenKnown(*argument, scope, form);
}

ConditionTemplate::Constants ConstantsOf(const TemplateForm& form, Dictionary& dictionary) {
  ConditionTemplate::Constants constants;
  for (const Term& constant : form.constants) constants.push_back(dictionary.Intern(constant));
  return constants;
}

bool SameConstants(const QuadPattern& a, const QuadPattern& b) {
  return a.subject == b.subject && a.predicate == b.predicate && a.object == b.object && a.graph == b.graph;
}

// Opens the constants of the patterns that every solution matches: those of the outermost conjunction.
void OpenConstants(Algebra& node, TemplateForm& form) {
  switch (node.kind) {
    case Algebra::Kind::kBgp:
      for (sparql::TriplePattern& triple : node.triples) {
        OpenTerm(triple.subject, form);
        const bool type = !triple.predicate.IsVariable() && triple.predicate.term().lexical == kRdfType;
        if (!type) OpenTerm(triple.object, form);
      }
      return;
    case Algebra::Kind::kJoin:
      for (const auto& child : node.children) OpenConstants(*child, form);
      return;
    case Algebra::Kind::kFilter:
      OpenConstants(*node.children[0], form);
      return OpenKnown(*node.expression, matching::CertainVariables(*node.children[0]), form);
    case Algebra::Kind::kMinus:
    case Algebra::Kind::kLeftJoin:
    case Algebra::Kind::kGraph:
      return OpenConstants(*node.children[0], form);
    default:
      return;
  }
}

}  // namespace

std::optional<TemplateForm> SplitConstants(const sparql::Query& query) {
  TemplateForm form;
  form.shared.form = sparql::Query::Form::kAsk;
  form.shared.from = query.from;
  form.shared.from_named = query.from_named;
  form.shared.algebra = matching::WithoutModifiers(*query.algebra).Clone();
  OpenConstants(*form.shared.algebra, form);
  if (form.parameters.empty()) return std::nullopt;
  return form;
}

ConditionTemplate::ConditionTemplate(uint32_t number, std::unique_ptr<matching::Body> body,
                                     WatchIndexes& indexes)
    : number_(number),
      body_(std::move(body)),
      all_certain_(std::all_of(body_->columns().begin(), body_->columns().end(),
                               [](const matching::Body::Column& column) { return column.certain; })),
      indexes_(indexes) {}

ConditionTemplate::~ConditionTemplate() {
  Unwatch();
}

absl::StatusOr<std::unique_ptr<ConditionTemplate>> ConditionTemplate::Make(
    uint32_t number, const TemplateForm& form, const matching::Body& member, WatchIndexes& indexes,
    Dictionary& dictionary, const sparql::FunctionRegistry* functions) {
  auto body = matching::Body::Compile(form.shared, dictionary, functions);
  if (!body.ok()) return body.status();
  std::unique_ptr<ConditionTemplate> condition_template(
      new ConditionTemplate(number, *std::move(body), indexes));
  for (const std::string& name : form.parameters) {
    const int column = condition_template->body_->ColumnOf(name);
    if (column < 0 || !condition_template->body_->columns()[column].certain) return nullptr;
    condition_template->parameters_.push_back(static_cast<int16_t>(column));
  }
  for (const matching::Body::Column& column : member.columns()) {
    const int found = condition_template->body_->ColumnOf(column.name);
    if (found < 0) return nullptr;
    condition_template->columns_.push_back(static_cast<int16_t>(found));
  }
  const std::vector<matching::Trigger>& open = condition_template->body_->triggers();
  if (open.size() != member.triggers().size() || member.is_volatile()) return nullptr;
  bool any = false;
  for (size_t i = 0; i < open.size(); ++i) {
    // without one of the constants both look at the same quads
    const bool shares = SameConstants(open[i].match.constants, member.triggers()[i].match.constants);
    condition_template->shared_.push_back(shares);
    any = any || shares;
  }
  condition_template->shares_any_ = any;
  condition_template->lends_body_ = condition_template->IsSame(member, ConstantsOf(form, dictionary));
  if (!any && !condition_template->lends_body_) return nullptr;
  for (const int16_t column : condition_template->parameters_) condition_template->body_->Hide(column);
  return condition_template;
}

ConditionKind& ConditionTemplate::KindWith(const ConditionKind::Keys& keys) {
  for (const auto& kind : kinds_) {
    if (kind->keys == keys) return *kind;
  }
  ConditionKind& kind =
      *kinds_.emplace_back(std::make_unique<ConditionKind>(*body_, keys, parameters_, indexes_));
  kind.condition_template = this;
  kind.borrows = true;
  return kind;
}

// True if the body with these constants matches the same quads as `member`, and binds the same values from
// them.
bool ConditionTemplate::IsSame(const matching::Body& member, const Constants& constants) const {
  ConditionKind kind(*body_, {}, parameters_, indexes_);
  const std::vector<TermId>& seed = kind.SeedWith(constants);
  for (size_t i = 0; i < shared_.size(); ++i) {
    const matching::Trigger& open = body_->triggers()[i];
    const matching::Trigger& closed = member.triggers()[i];
    const matching::MatchPattern match = body_->Instantiate(open, seed);
    if (!SameConstants(match.constants, closed.match.constants) || match.equal != closed.match.equal ||
        match.object_guard.has_value() != closed.match.object_guard.has_value() ||
        open.polarity != closed.polarity || open.required != closed.required) {
      return false;
    }
    for (size_t j = 0; j < closed.columns.size(); ++j) {
      const int16_t column = closed.columns[j];
      if (column != matching::Trigger::kNoColumn && open.columns[j] != columns_[column]) return false;
      const bool bound = open.columns[j] != matching::Trigger::kNoColumn && seed[open.columns[j]].IsNone();
      if (column == matching::Trigger::kNoColumn && bound) return false;
    }
  }
  for (size_t i = 0; i < columns_.size(); ++i) {
    const matching::Body::Column& open = body_->columns()[columns_[i]];
    const matching::Body::Column& closed = member.columns()[i];
    if (open.seedable != closed.seedable || open.certain != closed.certain) return false;
  }
  return body_->columns().size() == columns_.size() + parameters_.size();
}

void ConditionTemplate::Watch() {
  for (size_t i = 0; i < shared_.size(); ++i) {
    if (!shared_[i]) continue;
    const matching::Trigger& trigger = body_->triggers()[i];
    const matching::PatternIndex::Reference reference{number_ | WatchIndexes::kIsTemplate,
                                                      static_cast<uint32_t>(i)};
    const QuadPattern& constants = trigger.match.constants;
    if (RisesOnAdd(trigger.polarity)) watches_.push_back(indexes_.Comes(trigger.match, constants, reference));
    if (RisesOnRemove(trigger.polarity))
      watches_.push_back(indexes_.Goes(trigger.match, constants, reference));
  }
}

void ConditionTemplate::Unwatch() {
  indexes_.RemoveAll(watches_);
}

void ConditionTemplate::Join(uint32_t condition, const Constants& constants) {
  if (waiting_++ == 0) Watch();
  members_[constants].push_back(condition);
}

void ConditionTemplate::Leave(uint32_t condition, const Constants& constants) {
  const auto found = members_.find(constants);
  auto& conditions = found->second;
  conditions.erase(std::find(conditions.begin(), conditions.end(), condition));
  if (conditions.empty()) members_.erase(found);
  if (--waiting_ == 0) Unwatch();
}

std::vector<uint32_t> ConditionTemplate::Waiting() const {
  std::vector<uint32_t> all;
  for (const auto& [constants, conditions] : members_)
    all.insert(all.end(), conditions.begin(), conditions.end());
  std::sort(all.begin(), all.end());
  return all;
}

absl::StatusOr<bool> ConditionTemplate::Probe(uint32_t trigger, const Quad* quad, bool added,
                                              const sparql::RunOptions& run, Visitor visit) {
  if (quad != nullptr) {
    body_->SeedFrom(body_->triggers()[trigger], *quad, seed_);
  } else {
    ClearSeed(body_->columns().size(), seed_);
  }
  for (size_t i = 0; !all_certain_ && i < seed_.size(); ++i) {
    if (!body_->columns()[i].certain) seed_[i] = TermId();
  }
  size_t solutions = 0;
  const size_t most = 2 * waiting_ + kSpareSolutions;
  const auto take = [&](absl::Span<const TermId> row) {
    if (++solutions > most) return false;
    found_.clear();
    for (const int16_t column : parameters_) found_.push_back(row[column]);
    const auto members = members_.find(found_);
    if (members == members_.end()) return true;
    for (const uint32_t condition : members->second) visit(condition, row);
    return true;
  };
  const absl::Status status = quad != nullptr && added
                                  ? body_->EvaluateFrom(body_->triggers()[trigger], run, seed_, take)
                                  : body_->Evaluate(run, seed_, take);
  if (!status.ok()) return status;
  return solutions <= most;
}

}  // namespace docent::conditions
