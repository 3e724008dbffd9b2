#include "kb_server/subscriptions/subscription_answer.h"

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"
#include "graph/rdf/text_bytes.h"

namespace docent::server {
namespace {

std::string KeyOf(const CountedRow& row) {
  std::string key;
  for (const std::optional<Term>& value : row.values)
    absl::StrAppend(&key, value ? ToNTriples(*value) : "", " ");
  return key;
}

void SortRows(std::vector<CountedRow>& rows) {
  std::sort(rows.begin(), rows.end(),
            [](const CountedRow& a, const CountedRow& b) { return a.values < b.values; });
}

constexpr size_t kSmallBytes = 64u << 10;  // of a whole answer that stays

// As it stands twice, by number and by term.
size_t BytesOfLocal(const Term& term) {
  return 2 * (sizeof(Term) + TextBytes(term)) + sizeof(TermId);
}

size_t BytesOf(const AnswerChange& change) {
  size_t bytes = sizeof(AnswerChange);
  for (const std::vector<CountedRow>* rows : {&change.appeared, &change.disappeared}) {
    for (const CountedRow& row : *rows) {
      bytes += sizeof(CountedRow) + row.values.size() * sizeof(row.values[0]);
      for (const std::optional<Term>& value : row.values) bytes += value ? TextBytes(*value) : 0;
    }
  }
  return bytes;
}

}  // namespace

TermId SubscriptionAnswer::Local(const Term& term) {
  absl::MutexLock lock(&mutex_);
  const auto [place, fresh] = local_ids_.try_emplace(term, TermId::Make(TermId::Tag::kLocal, locals_.size()));
  if (fresh) {
    locals_.push_back(term);
    locals_bytes_ += BytesOfLocal(term);
  }
  return place->second;
}

CountedRow SubscriptionAnswer::Decode(const Row& row, uint64_t count) const {
  CountedRow out;
  out.count = count;
  for (const TermId id : row) {
    if (id.IsNone()) {
      out.values.push_back(std::nullopt);
    } else if (id.tag() == TermId::Tag::kLocal) {
      out.values.push_back(locals_[id.payload()]);
    } else {
      out.values.push_back(dictionary_.Decode(id));
    }
  }
  return out;
}

void SubscriptionAnswer::Keep(AnswerChange change) {
  change.number = ++newest_;
  change.revision = revision_;
  SortRows(change.appeared);
  SortRows(change.disappeared);
  kept_rows_ += change.appeared.size() + change.disappeared.size();
  const size_t bytes = BytesOf(change);
  kept_bytes_ += bytes;
  all_kept_->fetch_add(bytes);
  changes_.push_back({std::make_shared<const AnswerChange>(std::move(change)), bytes});
  while (changes_.size() > limits_.subscription_changes_kept || kept_rows_ > limits_.subscription_rows) {
    DropOldest();
    if (changes_.empty()) break;
  }
  // The newest stays, however large it is: those who follow at its pace have not seen it yet.
  while (changes_.size() > 1 &&
         (kept_bytes_ > limits_.subscription_kept_bytes || *all_kept_ > limits_.subscriptions_kept_bytes)) {
    DropOldest();
  }
}

void SubscriptionAnswer::DropOldest() {
  const KeptChange& oldest = changes_.front();
  kept_rows_ -= oldest.change->appeared.size() + oldest.change->disappeared.size();
  kept_bytes_ -= oldest.bytes;
  all_kept_->fetch_sub(oldest.bytes);
  changes_.pop_front();
}

SubscriptionAnswer::~SubscriptionAnswer() {
  all_kept_->fetch_sub(kept_bytes_);
}

bool SubscriptionAnswer::TellBoolean(TimeMicros now_us) {
  const bool tell = boolean_ && (told_ || now_us - boolean_since_us_ >= at_least_us_);
  if (tell == told_) return false;
  told_ = tell;
  return true;
}

bool SubscriptionAnswer::SetBoolean(Revision revision, bool holds, TimeMicros now_us) {
  absl::MutexLock lock(&mutex_);
  revision_ = revision;
  ForgetWhole();
  if (holds && !boolean_) boolean_since_us_ = now_us;
  boolean_ = holds;
  const bool changed = TellBoolean(now_us) && evaluated_;
  evaluated_ = true;
  if (changed) {
    AnswerChange change;
    change.boolean = told_;
    Keep(std::move(change));
  }
  return changed;
}

// A value that was computed here may have become a term of the dictionary since: one term, one id.
void SubscriptionAnswer::AdoptKnownLocals(Rows* fresh) {
  std::vector<std::pair<TermId, TermId>> known;
  for (const auto& [term, local] : local_ids_) {
    if (auto id = dictionary_.Find(term)) known.emplace_back(local, *id);
  }
  if (known.empty()) return;
  const auto renamed = [&known](Row row) {
    for (TermId& id : row) {
      for (const auto& [local, global] : known) {
        if (id == local) id = global;
      }
    }
    return row;
  };
  for (Rows* all : {&rows_, fresh}) {
    Rows rows;
    for (const auto& [row, count] : *all) rows[renamed(row)] += count;
    *all = std::move(rows);
  }
  young_.Rename(renamed);
  for (const auto& [local, global] : known) local_ids_.erase(locals_[local.payload()]);
}

// Computed values that no row holds any more go, once they are more than those that are held.
void SubscriptionAnswer::DropUnusedLocals() {
  if (locals_.size() < drop_locals_at_) return;
  std::vector<Term> held;
  absl::flat_hash_map<TermId, TermId> names;
  const auto renamed = [&](Row row) {
    for (TermId& id : row) {
      if (id.IsNone() || id.tag() != TermId::Tag::kLocal) continue;
      const auto [place, fresh] = names.try_emplace(id, TermId::Make(TermId::Tag::kLocal, held.size()));
      if (fresh) held.push_back(std::move(locals_[id.payload()]));
      id = place->second;
    }
    return row;
  };
  Rows rows;
  for (const auto& [row, count] : rows_) rows.emplace(renamed(row), count);
  rows_ = std::move(rows);
  young_.Rename(renamed);
  locals_ = std::move(held);
  local_ids_.clear();
  locals_bytes_ = 0;
  for (const Term& term : locals_) locals_bytes_ += BytesOfLocal(term);
  for (size_t i = 0; i < locals_.size(); ++i)
    local_ids_.emplace(locals_[i], TermId::Make(TermId::Tag::kLocal, i));
  drop_locals_at_ = 2 * locals_.size() + kFewLocals;
}

void SubscriptionAnswer::Recount(const Row& row, uint64_t had, uint64_t has, TimeMicros now_us,
                                 AnswerChange* change) {
  if (had == has) return;
  if (had == 0 && at_least_us_ > 0) return young_.Add(row, now_us);
  if (!evaluated_) return;  // the first answer is no change
  if (has == 0 ? young_.Remove(row) : young_.Contains(row)) return;
  if (has > had) {
    change->appeared.push_back(Decode(row, has - had));
  } else {
    change->disappeared.push_back(Decode(row, had - has));
  }
}

bool SubscriptionAnswer::SetRows(Revision revision, Rows rows, TimeMicros now_us) {
  absl::MutexLock lock(&mutex_);
  revision_ = revision;
  ForgetWhole();
  AdoptKnownLocals(&rows);
  AnswerChange change;
  for (const auto& [row, count] : rows) {
    const auto before = rows_.find(row);
    Recount(row, before == rows_.end() ? 0 : before->second, count, now_us, &change);
  }
  for (const auto& [row, had] : rows_) {
    if (!rows.contains(row)) Recount(row, had, 0, now_us, &change);
  }
  rows_ = std::move(rows);
  DropUnusedLocals();
  size_ = 0;
  for (const auto& [row, count] : rows_) size_ += count;
  evaluated_ = true;
  const bool changed = !change.appeared.empty() || !change.disappeared.empty();
  if (changed) Keep(std::move(change));
  return changed;
}

bool SubscriptionAnswer::ChangeRows(Revision revision, absl::Span<const Row> appeared,
                                    absl::Span<const Row> disappeared, TimeMicros now_us) {
  absl::flat_hash_map<Row, int64_t> net;
  for (const Row& row : appeared) ++net[row];
  for (const Row& row : disappeared) --net[row];
  absl::MutexLock lock(&mutex_);
  AnswerChange change;
  for (const auto& [row, count] : net) {
    if (count == 0) continue;
    const auto place = rows_.try_emplace(row, 0).first;
    const uint64_t had = place->second;
    const uint64_t has = had + static_cast<uint64_t>(count);
    place->second = has;
    size_ += static_cast<uint64_t>(count);
    if (has == 0) rows_.erase(place);
    Recount(row, had, has, now_us, &change);
  }
  if (change.appeared.empty() && change.disappeared.empty()) return false;
  revision_ = revision;
  ForgetWhole();
  Keep(std::move(change));
  return true;
}

std::optional<TimeMicros> SubscriptionAnswer::ripens_at_us() const {
  absl::MutexLock lock(&mutex_);
  if (is_boolean_)
    return boolean_ && !told_ ? std::make_optional(boolean_since_us_ + at_least_us_) : std::nullopt;
  const std::optional<TimeMicros> oldest = young_.oldest_us();
  return oldest ? std::make_optional(*oldest + at_least_us_) : std::nullopt;
}

bool SubscriptionAnswer::Ripen(Revision revision, TimeMicros now_us) {
  absl::MutexLock lock(&mutex_);
  AnswerChange change;
  if (is_boolean_) {
    if (!TellBoolean(now_us)) return false;
    change.boolean = told_;
  } else {
    for (const Row& row : young_.TakeUntil(now_us - at_least_us_))
      change.appeared.push_back(Decode(row, rows_.at(row)));
    if (change.appeared.empty()) return false;
  }
  revision_ = revision;
  ForgetWhole();
  Keep(std::move(change));
  return true;
}

size_t SubscriptionAnswer::size() const {
  absl::MutexLock lock(&mutex_);
  return size_;
}

bool SubscriptionAnswer::boolean() const {
  absl::MutexLock lock(&mutex_);
  return boolean_;
}

void SubscriptionAnswer::SetWarning(std::string warning) {
  absl::MutexLock lock(&mutex_);
  warning_ = std::move(warning);
}

std::string SubscriptionAnswer::warning() const {
  absl::MutexLock lock(&mutex_);
  return warning_;
}

bool SubscriptionAnswer::evaluated() const {
  absl::MutexLock lock(&mutex_);
  return evaluated_;
}

AnswerChangePtr SubscriptionAnswer::Whole() const {
  absl::MutexLock lock(&mutex_);
  if (AnswerChangePtr made = whole_.lock()) return made;
  auto whole = std::make_unique<AnswerChange>();
  whole->number = newest_;
  whole->revision = revision_;
  whole->boolean = told_;
  for (const auto& [row, count] : rows_) {
    if (!young_.Contains(row)) whole->appeared.push_back(Decode(row, count));
  }
  SortRows(whole->appeared);
  const size_t bytes = BytesOf(*whole);
  all_wholes_->fetch_add(bytes);
  const AnswerChangePtr made(whole.release(), [all = all_wholes_, bytes](const AnswerChange* sent) {
    delete sent;
    all->fetch_sub(bytes);
  });
  whole_ = made;
  if (bytes <= kSmallBytes) small_whole_ = made;
  return made;
}

void SubscriptionAnswer::ForgetWhole() {
  whole_.reset();
  small_whole_.reset();
}

size_t SubscriptionAnswer::bytes() const {
  absl::MutexLock lock(&mutex_);
  const size_t columns = variables_.size(), inlined = Row().capacity();
  const size_t beside = columns > inlined ? columns * sizeof(TermId) : 0;
  return sizeof(*this) + rows_.capacity() * (sizeof(Rows::value_type) + 1) + rows_.size() * beside +
         kept_bytes_ + locals_bytes_;
}

uint64_t SubscriptionAnswer::newest() const {
  absl::MutexLock lock(&mutex_);
  return newest_;
}

absl::StatusOr<AnswerChangePtr> SubscriptionAnswer::Get(uint64_t number) const {
  absl::MutexLock lock(&mutex_);
  if (number > newest_) return AnswerChangePtr();
  const uint64_t first = newest_ + 1 - changes_.size();
  if (number < first) return absl::OutOfRangeError("the change is no longer kept");
  return changes_[number - first].change;
}

absl::StatusOr<AnswerChangePtr> SubscriptionAnswer::Sum(uint64_t number) const {
  std::vector<AnswerChangePtr> parts;
  {
    absl::MutexLock lock(&mutex_);
    if (number > newest_) return AnswerChangePtr();
    const uint64_t first = newest_ + 1 - changes_.size();
    if (number < first) return absl::OutOfRangeError("the change is no longer kept");
    for (size_t i = number - first; i < changes_.size(); ++i) parts.push_back(changes_[i].change);
  }
  if (parts.size() == 1) return parts[0];
  struct Net {
    const CountedRow* row;
    int64_t count;
  };
  std::map<std::string, Net> net;
  for (const AnswerChangePtr& part : parts) {
    for (const CountedRow& row : part->appeared)
      net.try_emplace(KeyOf(row), Net{&row, 0}).first->second.count += static_cast<int64_t>(row.count);
    for (const CountedRow& row : part->disappeared)
      net.try_emplace(KeyOf(row), Net{&row, 0}).first->second.count -= static_cast<int64_t>(row.count);
  }
  auto sum = std::make_shared<AnswerChange>();
  sum->number = parts.back()->number;
  sum->revision = parts.back()->revision;
  sum->boolean = parts.back()->boolean;
  for (const auto& [key, entry] : net) {
    if (entry.count > 0) sum->appeared.push_back({entry.row->values, static_cast<uint64_t>(entry.count)});
    if (entry.count < 0) sum->disappeared.push_back({entry.row->values, static_cast<uint64_t>(-entry.count)});
  }
  SortRows(sum->appeared);
  SortRows(sum->disappeared);
  return AnswerChangePtr(std::move(sum));
}

}  // namespace docent::server
