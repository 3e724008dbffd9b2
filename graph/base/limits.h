// Every queue, loop, query, message and document has a named limit, and all of them stand here.
// An error at a limit says its name and value. Each is tested at the limit and one past it.
#ifndef DOCENT_GRAPH_BASE_LIMITS_H_
#define DOCENT_GRAPH_BASE_LIMITS_H_

#include <cstddef>
#include <cstdint>

namespace docent {

struct Limits {
  // door
  size_t inbox_batches = 65536;       // waiting batches; beyond: RESOURCE_EXHAUSTED
  size_t inbox_bytes = 256u << 20;    // text of all waiting batches; one batch may exceed it when none waits
  size_t batch_operations = 100000;   // quads, readings and reports in one Assert batch
  size_t batch_bytes = 16u << 20;     // text of one Assert batch
  size_t load_operations = 20000000;  // quads in one load (files, ontologies)
  size_t term_bytes = 1u << 20;       // text of one term
  size_t request_ids_remembered = 100000;  // newest request ids, for dropping repeats

  // turn
  int engine_rounds_per_turn = 64;     // store → rules → conditions → engine until quiet
  int rule_rounds = 10000;             // fixpoint rounds of a rule set
  size_t inferred_per_turn = 5000000;  // facts that one turn may infer
  // What the joins of rules and standing conditions may cost in one turn, in rows looked at. A turn that the log has is not
  // refused by them: what was decided stands.
  uint64_t steps_per_turn = 500000000;  // some seconds; and
  uint64_t steps_per_fact = 500;        // of the graph, those that the turn infers among them
  size_t turns_per_commit = 4096;       // turns that share one fdatasync
  size_t record_bytes = 1000000000;     // of one turn in the log: SQLite's SQLITE_MAX_LENGTH

  // durability and history
  size_t snapshot_records = 200000;        // turns after which another snapshot is taken, or
  size_t snapshot_log_bytes = 256u << 20;  // bytes of log records after which one is
  size_t snapshots_kept = 4;               // the two newest, and others that lie far apart, for as-of queries
  size_t log_bytes_kept =
      size_t{8} << 30;                 // about; older records go, but never those after the oldest snapshot
  size_t history_bytes = 32u << 20;    // memory of past graph versions kept for as-of queries
  size_t as_of_records = 1000000;      // records replayed to answer one as-of query
  size_t as_of_open = 2;               // past graphs made from the log that are in memory at one time
  size_t disk_free_bytes = 16u << 20;  // less on the log's disk: /healthz says so

  // queries
  int query_timeout_ms = 30000;
  int queries_running = 4;  // evaluated at the same time; a query that waits for its client is not counted
  int queries_open = 256;   // begun and not ended, those that wait for their clients or for a place too
  int queries_short = 2;    // evaluated beside those, each for query_short_ms: so short ones pass long ones
  int query_short_ms = 50;
  size_t queries_waiting = 1024;  // to begin; beyond: RESOURCE_EXHAUSTED
  size_t query_memory_bytes = 512u << 20;
  size_t queries_memory_bytes = size_t{2} << 30;  // of all queries and updates at the same time
  size_t query_text_bytes = 1u << 20;
  int query_nesting = 100;  // groups, expressions and sub-selects inside each other
  size_t query_elements =
      4000;  // OPTIONAL, MINUS, BIND, FILTER, groups and arithmetic operators in one query

  // the second engine, Rasqal (docent query --engine rasqal)
  size_t rasqal_rows = 1000000;     // of one answer
  size_t rasqal_quads = 10000000;   // of the copy of the graph that it works on
  int rasqal_optional_nesting = 6;  // OPTIONAL inside each other; preparing doubles with each

  // Redland programs
  int redland_answer_ms = 60000;  // waiting for the server's answer to one read or write

  // updates and other servers
  size_t update_text_bytes = 16u << 20;  // a SPARQL Update or a graph sent to the graph store
  int update_attempts = 3;               // evaluations beside the writer before one is made on its turn
  int update_turn_ms = 100;              // for that one
  size_t remote_bytes = 64u << 20;       // one answer to LOAD or SERVICE
  size_t remote_rows = 1000000;          // one answer to SERVICE

  // documents
  size_t document_bytes = 64u << 20;
  int xml_nesting = 64;
  int turtle_nesting = 256;          // brackets and collections inside each other
  size_t document_diagnostics = 20;  // mistakes reported of one document
  size_t xml_elements = 100000;      // in one CAWL or RSEL document

  // network
  size_t http_body_bytes = 64u << 20;
  size_t http_bodies_bytes = 512u << 20;  // of all requests that are read or answered at the same time
  size_t http_header_bytes = 64u << 10;   // of a request; chunk extensions and trailer fields likewise
  size_t http_header_fields = 256;
  size_t http_parameters = 10000;  // in a query string or form; parts of a multipart body
  size_t http_connections = 1024;
  size_t grpc_connections = 4096;
  size_t grpc_message_bytes = 16u << 20;
  size_t stream_messages = 1024;      // made for one gRPC client and not sent yet
  size_t stream_bytes = 4u << 20;     // likewise; one message may exceed it
  size_t streams_bytes = 256u << 20;  // likewise of all clients together; the largest streams are cut
  int slow_client_ms = 10000;   // a gRPC client that takes nothing of a full stream for so long loses it
  int crowded_client_ms = 500;  // likewise, while others wait for its place

  // workflow
  int default_step_timeout_ms = 300000;  // a node without cawl-ext timeout
  size_t runs_live = 10000;
  size_t runs_kept = 1000;  // ended runs whose facts stay in the graph; older ones are found in the log
  size_t run_events_kept = 10000;  // newest events of runs, for Watch with `after`
  int node_iterations = 10000;
  int subflow_nesting = 32;  // runs inside each other

  // Of a turn on a graph with so many facts.
  uint64_t StepsOfTurn(size_t facts) const { return steps_per_turn + steps_per_fact * facts; }
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_LIMITS_H_
