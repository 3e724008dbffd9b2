#include "graph/log/record_codec.h"

#include <google/protobuf/arena.h>

#include <array>
#include <deque>
#include <limits>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/hash/hash.h"
#include "absl/strings/str_cat.h"
#include "graph/log/record.pb.h"

namespace docent::log {
namespace {

// Enum values are written as numbers: their order is part of the log's format. New values are added at the
// end.
static_assert(static_cast<int>(TermKind::kLiteral) == record::TermEntry::LITERAL);
static_assert(static_cast<int>(WriteBatch::Mode::kLoad) == 1);
static_assert(static_cast<int>(Document::Kind::kRsel) == 3);
static_assert(static_cast<int>(Document::Action::kRemove) == 1);
static_assert(static_cast<int>(CommandReport::Outcome::kNotBegun) == 8);
static_assert(static_cast<int>(RunRequest::Kind::kCancelCommands) == 11);

// An arena whose first block lies on the stack: most records need no further block.
class RecordArena {
 public:
  RecordArena() : arena_(Options(&first_)) {}
  record::Turn* NewTurn() { return google::protobuf::Arena::CreateMessage<record::Turn>(&arena_); }

 private:
  using Block = std::array<char, 4096>;
  static google::protobuf::ArenaOptions Options(Block* first) {
    google::protobuf::ArenaOptions options;
    options.initial_block = first->data();
    options.initial_block_size = first->size();
    return options;
  }
  alignas(8) Block first_;
  google::protobuf::Arena arena_;
};

// Numbers the distinct terms of a record. The terms must outlive the table.
class TermTable {
 public:
  explicit TermTable(record::Turn* turn) : turn_(turn) {}

  uint32_t Number(const Term& term) {
    if (term == Term{}) return 0;
    if (const uint32_t known = Find(term); known > 0) return known;
    // The datatype comes first: a term refers only to terms before it.
    const uint32_t datatype = term.datatype.empty() ? 0 : NumberOfDatatype(term.datatype);
    record::TermEntry* entry = turn_->add_terms();
    entry->set_kind(static_cast<record::TermEntry::Kind>(term.kind));
    entry->set_lexical(term.lexical);
    entry->set_datatype(datatype);
    entry->set_language(term.language);
    const uint32_t number = static_cast<uint32_t>(turn_->terms_size());
    Keep(term, number);
    return number;
  }

  template <typename List>
  void AddNamed(const std::vector<std::pair<std::string, Term>>& values, List* list) {
    for (const auto& [name, value] : values) {
      record::NamedTerm* entry = list->Add();
      entry->set_name(name);
      entry->set_term(Number(value));
    }
  }

 private:
  struct HashTerm {
    size_t operator()(const Term* term) const { return absl::HashOf(*term); }
  };
  struct SameTerm {
    bool operator()(const Term* a, const Term* b) const { return *a == *b; }
  };

  // 0: no such term.
  uint32_t Find(const Term& term) const {
    if (numbers_.empty()) {
      for (const auto& [known, number] : few_) {
        if (*known == term) return number;
      }
      return 0;
    }
    const auto known = numbers_.find(&term);
    return known == numbers_.end() ? 0 : known->second;
  }
  void Keep(const Term& term, uint32_t number) {
    if (numbers_.empty() && few_.size() < kFew) {
      few_.emplace_back(&term, number);
      return;
    }
    if (numbers_.empty()) numbers_.insert(few_.begin(), few_.end());
    numbers_.emplace(&term, number);
  }

  uint32_t NumberOfDatatype(const std::string& iri) {
    const auto known = datatypes_.find(iri);
    if (known != datatypes_.end()) return known->second;
    const Term& term = owned_.emplace_back(Term::Iri(iri));
    return datatypes_[iri] = Number(term);
  }

  static constexpr size_t kFew = 8;  // up to this many terms, comparing each is faster than hashing

  record::Turn* turn_;
  absl::InlinedVector<std::pair<const Term*, uint32_t>, kFew> few_;
  absl::flat_hash_map<const Term*, uint32_t, HashTerm, SameTerm> numbers_;  // all terms, beyond kFew
  absl::flat_hash_map<std::string, uint32_t> datatypes_;
  std::deque<Term> owned_;  // datatypes as terms
};

void EncodeBatch(const WriteBatch& batch, TermTable* terms, record::Batch* out) {
  out->set_request_id(batch.request_id);
  out->set_request_digest(batch.request_digest);
  out->set_source(batch.source);
  out->set_mode(static_cast<uint32_t>(batch.mode));
  out->set_time_us(batch.time_us);
  out->set_lifetime_ms(batch.lifetime_ms);
  out->set_clock_tick(batch.clock_tick);
  out->mutable_quads()->Reserve(static_cast<int>(batch.operations.size() * 4));
  for (size_t i = 0; i < batch.operations.size(); ++i) {
    const TermQuad& quad = batch.operations[i].quad;
    for (const Term* term : {&quad.subject, &quad.predicate, &quad.object, &quad.graph}) {
      out->add_quads(terms->Number(*term));
    }
    if (batch.operations[i].kind == QuadOperation::Kind::kRemove) out->add_removes(static_cast<uint32_t>(i));
  }
  for (const SensorReading& reading : batch.readings) {
    record::Reading* entry = out->add_readings();
    entry->set_sensor(reading.sensor);
    entry->set_value(terms->Number(reading.value));
    entry->set_time_us(reading.time_us);
  }
  for (const Document& document : batch.documents) {
    record::DocumentChange* entry = out->add_documents();
    entry->set_kind(static_cast<uint32_t>(document.kind));
    entry->set_action(static_cast<uint32_t>(document.action));
    entry->set_name(document.name);
    entry->set_text(document.text);
  }
  for (const CommandReport& report : batch.reports) {
    record::Report* entry = out->add_reports();
    entry->set_command(report.command.value());
    entry->set_outcome(static_cast<uint32_t>(report.outcome));
    entry->set_message(report.message);
    entry->set_progress(report.progress);
    entry->set_incarnation(report.incarnation);
    terms->AddNamed(report.results, entry->mutable_results());
  }
  for (const RunRequest& request : batch.run_requests) {
    record::RunWish* entry = out->add_run_requests();
    entry->set_kind(static_cast<uint32_t>(request.kind));
    entry->set_target(request.target);
    terms->AddNamed(request.arguments, entry->mutable_arguments());
    entry->set_node(request.node);
    entry->set_robot(request.robot);
    entry->set_reason(request.reason);
    entry->set_cancels_commands(request.cancels_commands);
    entry->set_compensates(request.compensates);
  }
}

// The lowest kRecordReader that reads such a record right.
uint32_t ReaderOf(const WriteBatch& batch) {
  for (const CommandReport& report : batch.reports) {
    if (report.outcome == CommandReport::Outcome::kNotBegun) return 3;
  }
  for (const Document& document : batch.documents) {
    // an earlier one would remove all of the workflow
    if (document.action == Document::Action::kRemove && !document.text.empty()) return 2;
  }
  for (const RunRequest& request : batch.run_requests) {
    if (request.kind > RunRequest::Kind::kInvokeService || request.compensates || !request.reason.empty())
      return 2;
  }
  return 1;
}

void EncodeDecisions(const TurnRecord& record, TermTable* terms, record::Turn* turn) {
  for (const Transition& transition : record.transitions) {
    record::TransitionEntry* entry = turn->add_transitions();
    entry->set_subject(transition.subject);
    entry->set_from(transition.from);
    entry->set_to(transition.to);
    entry->set_cause(transition.cause);
  }
  for (const RobotCommand& command : record.commands) {
    record::Command* entry = turn->add_commands();
    entry->set_id(command.id.value());
    entry->set_robot(command.robot.value());
    entry->set_operation(command.operation);
    terms->AddNamed(command.arguments, entry->mutable_arguments());
    entry->set_expected_incarnation(command.expected_incarnation);
    entry->set_guard_revision(command.guard_revision.value());
    entry->set_deadline_us(command.deadline_us);
    entry->set_idempotent(command.idempotent);
  }
  for (const RunTelling& telling : record.told) {
    record::RunTelling* entry = turn->add_told();
    entry->set_by(telling.by);
    for (const Term* term :
         {&telling.quad.subject, &telling.quad.predicate, &telling.quad.object, &telling.quad.graph})
      entry->add_quad(terms->Number(*term));
  }
}

// Reads one parsed message. The first error is kept in `status`; later return values are then
// unused.
class Decoder {
 public:
  Decoder(uint64_t offset, const record::Turn& turn) : offset_(offset), turn_(turn) {}

  absl::StatusOr<TurnRecord> Decode() {
    if (turn_.min_reader() > kRecordReader) {
      return absl::FailedPreconditionError(absl::StrCat(
          "log record ", offset_, " was written by a newer Docent (record format ", turn_.min_reader(),
          ", this one reads up to ", kRecordReader, "): start the newer version"));
    }
    DecodeTerms();
    TurnRecord record;
    record.offset = offset_;
    record.time_us = turn_.time_us();
    record.engine_version = turn_.engine_version();
    DecodeBatch(turn_.batch(), &record.batch);
    DecodeDecisions(&record);
    if (!status_.ok()) return status_;
    return record;
  }

 private:
  void Fail(const std::string& what) {
    if (status_.ok())
      status_ = absl::DataLossError(absl::StrCat("log record ", offset_, " does not decode: ", what));
  }

  void DecodeTerms() {
    terms_.reserve(static_cast<size_t>(turn_.terms_size()) + 1);
    terms_.emplace_back();  // number 0: no term
    for (const record::TermEntry& entry : turn_.terms()) {
      Term term;
      if (entry.kind() < record::TermEntry::IRI || entry.kind() > record::TermEntry::LITERAL)
        Fail("unknown kind of term");
      term.kind = static_cast<TermKind>(entry.kind());
      term.lexical = entry.lexical();
      term.language = entry.language();
      if (entry.datatype() >= terms_.size()) {
        Fail("a datatype that stands after its literal");
      } else {
        term.datatype = terms_[entry.datatype()].lexical;
      }
      terms_.push_back(std::move(term));
    }
  }

  Term TermOf(uint32_t number) {
    if (number < terms_.size()) return terms_[number];
    Fail("a term number beyond the record's terms");
    return {};
  }

  // `value` as an enum whose last value is `last`.
  template <typename Enum>
  Enum EnumOf(uint32_t value, Enum last, const char* what) {
    if (value <= static_cast<uint32_t>(last)) return static_cast<Enum>(value);
    Fail(absl::StrCat("unknown ", what, " ", value));
    return last;
  }

  template <typename List>
  std::vector<std::pair<std::string, Term>> Named(const List& list) {
    std::vector<std::pair<std::string, Term>> values;
    values.reserve(static_cast<size_t>(list.size()));
    for (const record::NamedTerm& entry : list) values.emplace_back(entry.name(), TermOf(entry.term()));
    return values;
  }

  void DecodeOperations(const record::Batch& in, WriteBatch* batch) {
    if (in.quads_size() % 4 != 0) return Fail("quads of less than four terms");
    batch->operations.resize(static_cast<size_t>(in.quads_size() / 4));
    for (size_t i = 0; i < batch->operations.size(); ++i) {
      TermQuad& quad = batch->operations[i].quad;
      int at = static_cast<int>(i * 4);
      for (Term* term : {&quad.subject, &quad.predicate, &quad.object, &quad.graph})
        *term = TermOf(in.quads(at++));
    }
    for (const uint32_t position : in.removes()) {
      if (position >= batch->operations.size()) return Fail("a removal beyond the operations");
      batch->operations[position].kind = QuadOperation::Kind::kRemove;
    }
  }

  void DecodeBatch(const record::Batch& in, WriteBatch* batch) {
    batch->request_id = in.request_id();
    batch->request_digest = in.request_digest();
    batch->source = in.source();
    batch->mode = EnumOf(in.mode(), WriteBatch::Mode::kLoad, "batch mode");
    batch->time_us = in.time_us();
    batch->lifetime_ms = in.lifetime_ms();
    batch->clock_tick = in.clock_tick();
    DecodeOperations(in, batch);
    for (const record::Reading& entry : in.readings()) {
      batch->readings.push_back({entry.sensor(), TermOf(entry.value()), entry.time_us()});
    }
    for (const record::DocumentChange& entry : in.documents()) {
      batch->documents.push_back({EnumOf(entry.kind(), Document::Kind::kRsel, "kind of document"),
                                  EnumOf(entry.action(), Document::Action::kRemove, "document action"),
                                  entry.name(), entry.text()});
    }
    for (const record::Report& entry : in.reports()) {
      batch->reports.push_back({CommandId(entry.command()),
                                EnumOf(entry.outcome(), CommandReport::Outcome::kNotBegun, "command outcome"),
                                entry.message(), entry.progress(), entry.incarnation(),
                                Named(entry.results())});
    }
    for (const record::RunWish& entry : in.run_requests()) {
      batch->run_requests.push_back({EnumOf(entry.kind(), RunRequest::Kind::kCancelCommands, "run request"),
                                     entry.target(), Named(entry.arguments()), entry.node(), entry.robot(),
                                     entry.reason(), entry.cancels_commands(), entry.compensates()});
    }
  }

  void DecodeDecisions(TurnRecord* record) {
    for (const record::TransitionEntry& entry : turn_.transitions()) {
      record->transitions.push_back({entry.subject(), entry.from(), entry.to(), entry.cause()});
    }
    for (const record::Command& entry : turn_.commands()) {
      record->commands.push_back({CommandId(entry.id()), RobotId(entry.robot()), entry.operation(),
                                  Named(entry.arguments()), entry.expected_incarnation(),
                                  Revision(entry.guard_revision()), entry.deadline_us(), entry.idempotent()});
    }
    for (const record::RunTelling& entry : turn_.told()) {
      if (entry.quad_size() != 4) return Fail("a fact of a run with less than four terms");
      record->told.push_back(
          {entry.by(),
           {TermOf(entry.quad(0)), TermOf(entry.quad(1)), TermOf(entry.quad(2)), TermOf(entry.quad(3))}});
    }
  }

  const uint64_t offset_;
  const record::Turn& turn_;
  std::vector<Term> terms_;
  absl::Status status_;
};

}  // namespace

absl::StatusOr<std::string> EncodeTurnRecord(const TurnRecord& record) {
  RecordArena arena;
  record::Turn* turn = arena.NewTurn();
  turn->set_min_reader(ReaderOf(record.batch));
  turn->set_time_us(record.time_us);
  turn->set_engine_version(record.engine_version);
  TermTable terms(turn);
  EncodeBatch(record.batch, &terms, turn->mutable_batch());
  EncodeDecisions(record, &terms, turn);
  std::string bytes;
  if (turn->ByteSizeLong() > std::numeric_limits<int>::max() || !turn->SerializeToString(&bytes)) {
    return absl::InvalidArgumentError(
        absl::StrCat("a turn of ", turn->ByteSizeLong(), " bytes is too large for one log record"));
  }
  return bytes;
}

absl::StatusOr<TurnRecord> DecodeTurnRecord(uint64_t offset, std::string_view data) {
  RecordArena arena;
  record::Turn* turn = arena.NewTurn();
  if (data.size() > std::numeric_limits<int>::max() ||
      !turn->ParseFromArray(data.data(), static_cast<int>(data.size()))) {
    return absl::DataLossError(absl::StrCat("log record ", offset, " does not decode: not a record's bytes"));
  }
  return Decoder(offset, *turn).Decode();
}

}  // namespace docent::log
