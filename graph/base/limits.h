// The named limits of every queue, loop, query, message and document. An error at a limit gives its name and
// value. Each limit is tested at its value and one past it.
#ifndef DOCENT_GRAPH_BASE_LIMITS_H_
#define DOCENT_GRAPH_BASE_LIMITS_H_

#include <cstddef>
#include <cstdint>

namespace docent {

struct Limits {
  // door
  size_t inbox_batches = 65536;       // waiting batches; beyond: RESOURCE_EXHAUSTED
  size_t inbox_bytes = 256u << 20;    // text of all waiting batches; one batch may exceed it when none waits
  size_t batch_operations = 100000;   // facts, readings and reports in one Assert batch
  size_t batch_bytes = 16u << 20;     // text of one Assert batch
  size_t load_operations = 20000000;  // facts in one load (files, ontologies)
  size_t term_bytes = 1u << 20;       // text of one term
  size_t request_ids_remembered = 100000;  // newest request ids that are kept to recognise repeats

  // turn
  int engine_rounds_per_turn = 64;     // rounds of store, rules, conditions and engine until a turn is quiet
  int rule_rounds = 10000;             // rounds of a rule set until it makes nothing new
  size_t inferred_per_turn = 5000000;  // facts that one turn may infer
  // The two limits together bound a turn: steps_per_turn + steps_per_fact * facts of the graph. These facts
  // include the facts that the turn asserts, but not those that it infers. A step takes about 10 ns
  // (graph/base/step_costs.h). Replay of a logged turn is never refused by them: recorded decisions stand.
  uint64_t steps_per_turn = 250000000;  // steps of rules and conditions in one turn: about two seconds
  uint64_t steps_per_fact = 100;        // steps for each fact of the graph, in addition to steps_per_turn
  size_t turns_per_commit = 4096;       // turns that share one fdatasync
  size_t record_bytes = 1000000000;     // record of one turn in the log (SQLITE_MAX_LENGTH of SQLite)

  // durability and history
  size_t snapshot_records = 200000;  // turns after which another snapshot is taken
  size_t snapshot_log_bytes =
      256u << 20;             // log records after which another snapshot is taken, whatever their number
  size_t snapshots_kept = 4;  // snapshots: the two newest, and others spread over time, for as-of queries
  size_t log_bytes_kept =
      size_t{8} << 30;  // log, about; older records are deleted, but none after the oldest snapshot
  size_t history_bytes = 32u << 20;    // memory of past graph versions that are kept for as-of queries
  size_t as_of_records = 1000000;      // records replayed to answer one as-of query
  size_t as_of_open = 2;               // past graphs rebuilt from the log that are in memory at the same time
  size_t disk_free_bytes = 16u << 20;  // free space on the log's disk below which /healthz reports it

  // queries
  int query_timeout_ms = 30000;  // time of one query; a client may ask for less
  int queries_running =
      4;                   // queries evaluated at the same time; one that waits for its client does not count
  int queries_open = 256;  // queries begun and not ended, including those that wait for a client or a worker
  int queries_short = 2;  // queries evaluated in addition, each for query_short_ms: short ones pass long ones
  int query_short_ms = 50;                 // time after which a query no longer counts as short
  size_t queries_waiting = 1024;           // queries that wait to begin; beyond: RESOURCE_EXHAUSTED
  size_t query_memory_bytes = 512u << 20;  // memory of one query or update
  // The first 256 KiB of each come on top: at most 256 KiB * queries_open of queries.
  size_t queries_memory_bytes = size_t{2} << 30;  // memory of all queries and updates at the same time
  size_t query_text_bytes = 1u << 20;             // text of one query
  int query_nesting = 100;                        // groups, expressions and sub-selects inside each other
  size_t query_elements =
      4000;  // OPTIONAL, MINUS, BIND, FILTER, groups and arithmetic operators in one query

  // the second engine, Rasqal (docent query --engine rasqal)
  size_t rasqal_rows = 1000000;     // rows of one answer
  size_t rasqal_quads = 10000000;   // facts in the copy of the graph that Rasqal works on
  int rasqal_optional_nesting = 6;  // OPTIONAL inside each other; the time to prepare doubles with each

  // Redland programs
  int redland_answer_ms = 60000;  // wait for the server's answer to one read or write

  // updates and other servers
  size_t update_text_bytes = 16u << 20;  // text of a SPARQL Update, or of a graph sent to the graph store
  int update_attempts = 3;          // evaluations beside the writer before an update is evaluated in its turn
  int update_turn_ms = 100;         // time of an update that is evaluated in its turn
  size_t remote_bytes = 64u << 20;  // one answer to LOAD or SERVICE
  size_t remote_rows = 1000000;     // rows of one answer to SERVICE

  // documents
  size_t document_bytes = 64u << 20;  // text of one document
  int xml_nesting = 64;               // elements inside each other in a CAWL or RSEL document
  int turtle_nesting = 256;           // brackets and collections inside each other
  size_t document_diagnostics = 20;   // mistakes reported of one document
  size_t xml_elements = 100000;       // elements in one CAWL or RSEL document

  // network
  size_t http_body_bytes = 64u << 20;  // body of one request
  // The first 256 KiB of each request come on top: at most 256 KiB * http_connections together.
  size_t http_bodies_bytes = 512u << 20;  // bodies of all requests that are read or answered at the same time
  size_t http_header_bytes =
      64u << 10;                    // header of one request; also its chunk extensions and trailer fields
  size_t http_header_fields = 256;  // fields in the header of one request
  size_t http_parameters = 10000;   // parameters in a query string or form; parts of a multipart body
  size_t http_connections = 1024;   // HTTP connections at the same time
  size_t grpc_connections = 4096;   // gRPC connections at the same time
  size_t grpc_message_bytes = 16u << 20;  // one gRPC message
  size_t stream_messages = 1024;          // messages made for one gRPC client and not sent yet
  size_t stream_bytes =
      4u << 20;  // messages made for one gRPC client and not sent yet; one message may exceed it
  size_t streams_bytes =
      256u << 20;  // unsent messages of all clients together; beyond, the largest streams are closed
  int slow_client_ms =
      10000;  // time in which a gRPC client reads nothing from a full stream, after which it is closed
  int crowded_client_ms = 500;  // the same time, while other clients wait

  // workflow
  int default_step_timeout_ms = 300000;  // time of an invocation that has no ext:timeout of its own
  size_t runs_live = 200000;             // runs that have not ended
  size_t runs_kept = 1000;  // ended runs whose facts stay in the graph; older ones are found in the log
  size_t run_events_kept = 10000;  // newest events of runs, for a client that comes back
  int node_iterations = 10000;     // times that one node is entered in one run
  int subflow_nesting = 32;        // runs inside each other

  // The limit of steps for a turn on a graph with `facts` facts.
  uint64_t StepsOfTurn(size_t facts) const { return steps_per_turn + steps_per_fact * facts; }
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_LIMITS_H_
