// The syntax tree of a CAWL document (Context-Aware Workflow Language; Choi et al., IJDSN 2014, in the structure that
// the language's editors and engines read). One struct an element; its concrete syntax stands above it.
//
// Every Text knows its bytes in the source, so that editing is text editing. Made by ParseCawl, then never changed;
// held by DocumentPtr, which runs keep (a run goes on with the version that started it). Any thread.
//
// How bindings flow. A `variable` lives in the scope that declares it (cawl, activator, flow, node) and inner scopes
// see it. When a condition opens a node, each free variable ?x of its match is stored as variable x of the flow
// (whether or not it is declared; declaring it makes `$x` legal elsewhere). From then on `$x` is that value. Before,
// `$x` is like ?x: free, bound by the match. What an activator's match binds is stored in the flow that it starts.
// An invocation's arguments: each input part of the operation takes its ext:input, or the variable of the same name. The
// variable `robot`, when set, decides which robot serves.
#ifndef DOCENT_WORKFLOW_CAWL_AST_H_
#define DOCENT_WORKFLOW_CAWL_AST_H_

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/term.h"
#include "workflow/cawl/expression.h"
#include "workflow/xml/xml_document.h"

namespace docent::sparql {
struct Query;
}  // namespace docent::sparql

namespace docent::cawl {

using xml::Text;

// Docent's extensions: the elements tell, withdraw, assign, notify, input and output, and the attributes timeout, retry, retry-delay,
// retry-backoff, retry-other-robot, onFailure, onInterrupt, compensate, forEach, sequential, while, while-holds, for, mode, max.
inline constexpr std::string_view kExtensionNs = "https://w3id.org/docent/cawl-ext#";

// <part name="booth" type="docent:Booth" element="…"/>
struct Part {
  Text name;
  Text type;  // a class or datatype as prefix:local; kept as written
  Text element;
  SourceSpan span;
  std::optional<Term> type_term = {};  // its IRI, where it is one
};

// <message name="GuideRequest"> part* </message>
struct Message {
  Text name;
  std::vector<Part> parts;
  SourceSpan span;
};

// <initialize part="booth"> <from variable="request" part="booth"/> </initialize>
// <initialize> <from expression="expo:B03"/> </initialize>
// Without `part` the whole variable is meant. `expression` is one value: prefix:local, <iri>, "text", a number,
// true, false, or $variable. Exactly one of `value` and `copy_of` is set in a correct document.
struct Initialize {
  Text part;
  Text from_variable;
  Text from_part;
  Text from_expression;
  std::optional<Term> value;  // the value of `expression`
  std::string copy_of;        // or the variable to copy: "name" or "name.part"
  SourceSpan span;
};

// <variable name="user" type="docent:Visitor"> initialize* </variable>
// `type` is a message's name (the variable then has parts, written $name.part, kept under "name.part"), or a class
// or datatype as prefix:local (for people and for checks). ext:required="true": a run of the flow does not begin without a value.
struct Variable {
  Text name;
  Text type;
  std::optional<Term> type_term;  // its IRI, where it is prefix:local or <iri>
  std::vector<Initialize> initializers;
  bool required = false;
  SourceSpan span;
};

// <ontology location="docent-place.ttl" namespace="https://w3id.org/docent#"/>
struct Ontology {
  Text location;
  Text namespace_iri;
  SourceSpan span;
};

// <service operation="moveToUser"/>
struct Service {
  Text operation;
  SourceSpan span;
};

// <serviceProvider name="R01" location="…"> service* </serviceProvider>
struct ServiceProvider {
  Text name;
  Text location;
  std::vector<Service> services;
  SourceSpan span;
};

// The word in a subject, verb or object.
//   $name  $name.part   a variable of the symbol table
//   ?name               a free variable that the match binds
//   prefix:local <iri>  a resource; the verb `a` is rdf:type
//   "text" "text"@en "1"^^xsd:int 3.5 true   a literal
//   > 0.5   != <iri>   <= $limit             objects only: a comparison with one of the above
// Prefixes are those of the XML namespaces in scope and the well-known ones of graph/rdf/vocabulary.h.
struct Word {
  enum class Kind { kMissing, kVariable, kFree, kTerm };
  enum class Comparison { kNone, kEqual, kNotEqual, kLess, kLessOrEqual, kGreater, kGreaterOrEqual };
  Kind kind = Kind::kMissing;
  Comparison comparison = Comparison::kNone;
  std::string name;               // kVariable ("name" or "name.part"), kFree
  Term term;                      // kTerm
  Text text;                      // as written
  SourceSpan span;                // of the word itself, without the comparison
  Text type;                      // @type as written
  std::optional<Term> type_term;  // its IRI
};

// <constraint name="near"> <subject type="docent:Robot">?robot</subject> <verb>docent:isAt</verb>
//                          <object>$place</object> </constraint>
struct Constraint {
  Text name;
  Word subject;
  Word verb;
  Word object;
  SourceSpan span;
  // Of an <ext:time>, as the facts of the clock have it (time_reader.h): it holds for a while, or occurs and is an event.
  enum class Time { kNone, kLasts, kOccurs };
  Time time = Time::kNone;
};

// <rule name="standby" expression="near and not busy"> constraint* </rule>
// Without expression all constraints must hold.
// ext:for="5s": the rule must have held for at least so long, without a break and with the same values of its
// variables (see lasting_rules.h). With expression="not seen", that is "not seen for 5 s".
struct Rule {
  Text name;
  Text for_text;
  std::optional<int64_t> at_least_ms;
  Text expression_text;
  std::optional<Expression> expression;
  std::vector<Constraint> constraints;  // and what its <ext:time> children say
  // <ext:time after="30s"/>: the context opens no earlier, counted from when the node is entered.
  Text after_text;
  std::optional<int64_t> after_ms;
  SourceSpan span;
};

// <context name="C1" priority="1"> rule* </context>
// All rules must hold, with the same bindings of their free variables.
struct Context {
  Text name;
  Text priority_text;
  int priority = 0;  // lower is tried first
  std::vector<Rule> rules;
  SourceSpan span;
};

// <event operation="doorbell"/>
// An event is the fact `?e a docent:Event ; docent:operation "doorbell"`; it counts in the turn that tells it;
// where only robots that serve other runs could take it, when one of them is freed, if it still stands.
struct Event {
  Text operation;
  SourceSpan span;
};

// <case name="rang" expression="doorbell or knock"> event* </case>
// The names of the expression are the events' operations. Without expression all events are needed.
struct Case {
  Text name;
  Text expression_text;
  std::optional<Expression> expression;
  std::vector<Event> events;
  SourceSpan span;
};

// <condition expression="rang and C1"> case? context* </condition>
// Without expression the contexts and the case are alternatives: contexts by priority (ties in document order),
// then the case. With one, it is over the names of contexts and case, and the condition is a single alternative.
// Without any child the condition holds at once.
struct Condition {
  Text expression_text;
  std::optional<Expression> expression;
  std::vector<Case> cases;  // at most one in a correct document
  std::vector<Context> contexts;
  Text timeout_text;
  std::optional<int64_t> timeout_ms;  // ext:timeout: the longest wait; then the node fails
  SourceSpan span;
};

// A SELECT or an expression over variables of the run ($name), as a query that is ready to be asked.
struct Computation {
  struct Call {
    std::string function;  // IRI
    size_t arguments = 0;
    SourceSpan place;
  };
  Text text;                                   // as written
  std::shared_ptr<const sparql::Query> query;  // a SELECT also for an expression; null after a mistake
  std::vector<std::string> inputs;             // variables of the run that it uses
  std::vector<SourceSpan> input_places;        // of their first uses
  std::vector<Text> outputs;                   // what its columns are called, in their order
  std::vector<Call> calls;                     // of functions that SPARQL itself does not have
  bool ordered = false;                        // it has ORDER BY
  // Of an expression: ?name outside of EXISTS { … }, to which nothing gives a value; what it is if it is one literal or resource.
  std::vector<std::pair<std::string, SourceSpan>> without_value;
  std::optional<Term> constant;
};

// <ext:input part="text" expression='"Hello"'/>   <ext:input part="place" variable="stand"/>
// In an invoke: what is invoked gets this as its input `part`, in place of the variable of that name.
struct Input {
  Text part;
  Text variable;         // of the run; "request.booth" too
  Computation computed;  // without `variable`: an expression
  SourceSpan span;
};

// <ext:output part="temperature" variable="measured"/>
// In an invoke: the result `part` of what is invoked becomes a variable of the run. In a flow: the flow gives back a variable,
// under the name `part` (without it: the variable's).
struct Output {
  Text part;
  Text variable;
  SourceSpan span;
};
// ext:retry-delay="10s" ext:retry-backoff="2" ext:retry-other-robot="true", beside ext:retry: how the next attempt begins.
struct RetryPolicy {
  Text delay_text;
  std::optional<int64_t> delay_ms;  // from the failure to the next attempt
  double backoff = 1;               // factor from one delay to the next
  bool other_robot = false;         // not on a robot that has failed it, while another one offers it
};

// ext:onFailure of a node, or of a flow for its nodes: what becomes of a node that failed. kIncident: it waits for an
// operator. kFail: it takes its links with onFailure, or the run fails. kUnset: as the flow says, else kFail.
enum class OnFailure { kUnset, kFail, kIncident };

// <invoke operation="moveToUser"/>  or  <invoke subflow="BoothGuide"/>
// `operation`: an RSEL process or, if there is none of that name, an operation that robots offer.
// <invoke ext:capability="docent:SpeechSynthesis"/>: an operation of this class or of one below it, whatever its name is.
// `operation` is then "<IRI of the class>".
// `subflow`: a flow of this document or a registered application service.
struct Invoke {
  Text operation;
  Text capability;  // as written; not given: `operation` is a name
  Text subflow;
  Text timeout_text;
  std::optional<int64_t> timeout_ms;  // ext:timeout: of each attempt
  int retry = 0;                      // ext:retry: further attempts after a failure
  std::vector<Input> inputs;          // ext:input: parts that are not named take the variables of their names
  std::vector<Output> outputs;        // ext:output: none: each result becomes the variable of its name
  RetryPolicy retry_policy;
  Text choose_text;
  std::string
      choose;  // ext:choose: a SELECT of ?robot (robot_choice.h), with its prefixes; empty: the default
  SourceSpan span;

  const Input* FindInput(std::string_view part) const;  // null: none of that name
};

// What a node does itself, beside what it invokes, in the order of the document.
//
// <ext:tell at="open" lifetime="run"> constraint+ </ext:tell>      or lines of "subject verb object"
//   The run tells the facts: they lie in the graph of its IRI. They stay after the run, or until it ends ("run"), or for a
//   time ("30s").
// <ext:withdraw at="done" source="any"> likewise </ext:withdraw>
//   Takes away what the run told ("own"), or what anybody told ("any"). ?name that the node's condition does not bind matches
//   anything; where it stands twice in one constraint, the same.
//
// <ext:assign none="unset"> SELECT ?place (COUNT(?guest) AS ?guests) WHERE { … $user … } … </ext:assign>
// <ext:assign variable="n" expression="$n + 1"/>
//   Variables of the run: those of the projection, or `variable`, which takes the one column. $name is the value of a variable.
//   The first solution counts: in term order, or in the order of ORDER BY. Without a solution or value, the node fails
//   (none="fail"), or the variables have none (none="unset"), or this one (default="0").
//
// <ext:notify to="https://example.org/hook" type="org.example.arrived" subject="$user" variables="user place" wait="true"/>
//   A CloudEvent to a webhook or, to="mqtt:TOPIC", to a topic. The node goes on at once, or when it is delivered.
//
// <ext:reserve robots="$robot expo:R02" lasting="10min" priority="5"/>   <ext:release/>
//   Keeps robots for the run and those nested in it, all of them or none. It ends with the run that reserves, after a time, or
//   by ext:release. Another ext:reserve replaces it.
// <ext:release robots="$lift"/>
//   Gives back robots that the run holds, with those that it is nested in. The reservation stays.
//
// <ext:fail reason="the door is locked"/>
//   The node fails, without another attempt. `reason` may be $name.
//
// `at`: "open", when the node opens and before its invokes; "done", when all its invokes are done; "failure" (of tell, withdraw and
// notify), when the node has failed for good, before its run goes on or ends.
inline constexpr char kDefaultEventType[] = "org.w3id.docent.notification";

struct Action {
  enum class Kind : uint8_t { kTell, kWithdraw, kAssign, kNotify, kReserve, kRelease, kFail };
  enum class When : uint8_t { kOpen, kDone, kFailure };
  Kind kind = Kind::kTell;
  When when = When::kOpen;
  std::vector<Constraint>
      facts;  // without comparisons and types. kReserve, kRelease: ROBOT docent:reservedBy docent:Reservation
  std::optional<int64_t> lifetime_ms;
  bool until_run_ends = false;  // lifetime="run"
  bool any_source = false;
  Computation computed;           // kAssign: its outputs are the variables that are set
  bool may_be_none = false;       // none="unset"
  std::optional<Term> otherwise;  // default
  Text otherwise_text;
  Text reason;  // kFail: a text, or $name
  // kNotify
  std::vector<Text> data;  // names of variables
  Text target;             // "https://…", "mqtt:TOPIC" or $name
  std::vector<std::pair<std::string, SourceSpan>>
      uses;            // variables of `target`, `event_subject` and `reason`
  Text event_type;     // empty: kDefaultEventType
  Text event_subject;  // a text, or $name
  bool waits = false;  // wait="true"
  // kReserve; `lifetime_ms` is how long it lasts
  std::optional<int> priority;  // none: that of the run
  SourceSpan span;
};

// <node name="Move2User" state="deActivate"> message* variable* wait* condition? invoke* action* </node>
// <wait joinCondition="A and B"/>: names of predecessors; without it, all that can still come.
// A node without invokes is done as soon as its condition opens it.
struct Node {
  Text name;
  Text state;  // Activate | deActivate; kept for round trip
  std::vector<Message> messages;
  std::vector<Variable> variables;
  Text join_text;  // wait @joinCondition (several waits: joined by `and`)
  std::optional<Expression> join;
  std::optional<Condition> condition;
  std::vector<Invoke> invokes;
  std::vector<Action> actions;  // ext:tell and the like
  Text timeout_text;
  std::optional<int64_t> timeout_ms;  // ext:timeout: from the opening of its condition to done
  int retry = 0;                      // ext:retry: the whole node again after a failure
  RetryPolicy retry_policy;
  Text on_failure_text;
  OnFailure on_failure = OnFailure::kUnset;
  Text
      compensate;  // ext:compensate: operation that undoes what this node did, when the run fails or is cancelled so
  Text for_each_text;  // ext:forEach="?booth ?visitor": the invokes once for each binding of these
  std::vector<std::string> for_each;  // without "?"
  bool sequential = false;            // ext:sequential="true": of forEach, one binding after the other
  // ext:while-holds="true" (the node's own condition, with the match that opened it) or "subject verb object": what has to
  // hold while the node runs. When it falls, the node's commands are cancelled, and it takes its links with onInterrupt, or
  // waits again.
  Text hold_text;
  bool holds_condition = false;
  std::optional<Constraint> hold;
  size_t position = 0;  // in the order of the flow, from 1 (flow_order.h)
  SourceSpan span;
};

// <link from="Move2User" to="Move2Booth"/>
struct Link {
  Text from;
  Text to;
  bool on_failure = false;  // ext:onFailure="true": followed when `from` fails, and only then
  bool on_interrupt =
      false;  // ext:onInterrupt="true": followed when the while-holds of `from` falls, and only then
  // ext:while="$user docent:selected ?booth": followed when `from` is done and this holds; the links without `while`
  // out of the same node are followed when it does not. The only links that may close a cycle.
  Text while_text;
  std::optional<Constraint> while_constraint;
  SourceSpan span;
};

// ext:priority="10" ext:preempt="true" of a flow or an activator: how urgent its runs are (UrgencyOf).
inline constexpr int kMaxPriority = 1000;  // and at least -kMaxPriority
struct Urgency {
  int priority = 0;       // the higher, the sooner a run gets a robot
  bool preempts = false;  // it may take a robot from runs of lower priority, between two of their steps
};

// <flow name="BoothGuide"> message* variable* <source name="s"/> node* <sink name="t"/> link* output* </flow>
struct Flow {
  Text name;
  OnFailure on_failure = OnFailure::kUnset;  // of nodes that do not say it and have no link with onFailure
  std::vector<Message> messages;
  std::vector<Variable> variables;
  Text source;
  Text sink;
  std::vector<Node> nodes;
  std::vector<Link> links;
  std::vector<Output> outputs;  // ext:output: the results of the flow; none: it does not say
  std::optional<Urgency> urgency;
  SourceSpan span;
};

// ext:mode of an activator: what becomes of a firing while runs of the same key are live, or firings wait.
//   kSingle    ignored
//   kQueued    waits until they have ended; ignored where ext:max wait already
//   kRestart   they are cancelled
//   kParallel  another run starts; ignored where ext:max are live already. The default
// The key of a firing is what its binding gives to the key variables, without the events.
enum class ActivatorMode : uint8_t { kParallel, kSingle, kQueued, kRestart };

// <activator name="OnChoice" ext:mode="queued" ext:max="5"> message* variable* <activate flow="BoothGuide"/> condition </activator>
// One run of the flow for each new binding of the key variables: those of the activator's own variables that the
// condition binds; if it declares none, all that the condition binds (see KeyVariables in ask_compiler.h).
struct Activator {
  Text name;
  std::vector<Message> messages;
  std::vector<Variable> variables;
  Text flow;
  Text mode_text;
  ActivatorMode mode = ActivatorMode::kParallel;
  Text max_text;
  std::optional<int> max;  // ext:max; from 1
  Condition condition;
  std::optional<Urgency> urgency;
  SourceSpan span;
};

// <CAWL name="BoothGuide" namespace="…" version="1.0">
//   message* variable* baseOntologies( ontology* ) serviceProvider* activator? flow*
// </CAWL>
struct Document {
  std::string file;    // as the user named it
  std::string source;  // the text that all spans point into
  Text name;
  Text namespace_iri;
  Text version;
  std::vector<Message> messages;
  std::vector<Variable> variables;
  std::vector<Ontology> ontologies;
  std::vector<ServiceProvider> providers;
  std::optional<Activator> activator;
  std::vector<Flow> flows;
  // Prefixes of the root element's XML namespaces, for printing SPARQL the way the author writes.
  std::map<std::string, std::string> prefixes;
  SourceSpan span;

  const Flow* FindFlow(std::string_view flow_name) const;
  // The flow that a start of this document means: `flow_name`, or where that is empty the activator's flow, or the first.
  const Flow* FlowToStart(std::string_view flow_name) const;
};

using DocumentPtr = std::shared_ptr<const Document>;

// Of runs of the flow: its own, or where it has none, that of the activator that starts it.
Urgency UrgencyOf(const Document& document, const Flow& flow);

// What a text that asks for a start may mean, in the order in which it is tried: (workflow, flow), flow empty for the one of
// FlowToStart. "A/B" is the workflow A/B, or flow B of the workflow A: names may have slashes.
std::vector<std::pair<std::string, std::string>> StartTargets(std::string_view text);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_AST_H_
