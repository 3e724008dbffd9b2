// Client of a Docent server for browsers and Node: the services of its API over the Connect protocol, live connections, and RDF
// terms. One object for one server:
//
//   const docent = connectDocent("http://127.0.0.1:7480");
//   await docent.tell([fact(expo("John"), docentTerm("chose"), expo("BoothGuideService"))]);
//   for (const row of await docent.select("SELECT ?r { ?r a docent:Robot }")) console.log(row.r);
//   const stop = docent.watch("SELECT ?who { ?who docent:isAt expo:B05 }", (rows) => console.log(rows.length));
import {
  create,
  fromJson,
  toJson,
  type DescMessage,
  type MessageInitShape,
  type MessageShape,
} from "@bufbuild/protobuf";
import { type Client, createClient, type Interceptor, type Transport } from "@connectrpc/connect";
import { createConnectTransport } from "@connectrpc/connect-web";
import {
  AssertRequestSchema,
  Context,
  SubscribeReplySchema,
  SubscribeRequestSchema,
  type AssertReply,
} from "./gen/docent/v1/context_pb.js";
import { Fleet } from "./gen/docent/v1/fleet_pb.js";
import { Ontologies } from "./gen/docent/v1/ontologies_pb.js";
import { Replays } from "./gen/docent/v1/replays_pb.js";
import { RobotServices } from "./gen/docent/v1/robot_services_pb.js";
import type { Quad } from "./gen/docent/v1/term_pb.js";
import { Workflows } from "./gen/docent/v1/workflows_pb.js";
import { type Failure, LiveConnection, type Socket } from "./live_connection.js";
import { type Row, valueOf } from "./terms.js";
import { WatchedAnswer } from "./watched_answer.js";

export * from "./gen/docent/v1/context_pb.js";
export * from "./gen/docent/v1/fleet_pb.js";
export * from "./gen/docent/v1/ontologies_pb.js";
export * from "./gen/docent/v1/replays_pb.js";
export * from "./gen/docent/v1/robot_services_pb.js";
export * from "./gen/docent/v1/term_pb.js";
export * from "./gen/docent/v1/workflows_pb.js";
export * from "./live_connection.js";
export * from "./terms.js";
export type { Row } from "./terms.js"; // and not the message of that name

export interface DocentOptions {
  interceptors?: Interceptor[];
  timeoutMs?: number; // of a call that names none; streams have none. Default: 30 s
  transport?: Transport; // in place of the one for `address`
}
export interface Docent {
  readonly context: Client<typeof Context>;
  readonly fleet: Client<typeof Fleet>;
  readonly ontologies: Client<typeof Ontologies>;
  readonly replays: Client<typeof Replays>;
  readonly services: Client<typeof RobotServices>;
  readonly workflows: Client<typeof Workflows>;
  // Tells facts. A call that is repeated with the same id after a lost connection is applied once.
  tell(
    add: readonly Quad[],
    more?: { source?: string; remove?: readonly Quad[]; requestId?: string },
  ): Promise<AssertReply>;
  // The rows of a SELECT, by the names of its variables.
  select(query: string, signal?: AbortSignal): Promise<Row[]>;
  ask(query: string, signal?: AbortSignal): Promise<boolean>;
  // Follows a query: `onRows` has the whole answer at first and after each change, in no order, until the returned function is called.
  // An ASK that is true is one row without variables. `everyMs`: changes come at most so often. What the server refuses ends it: `onEnd`,
  // or else the console says why.
  watch(
    query: string,
    onRows: (rows: Row[]) => void,
    more?: { everyMs?: number; onEnd?: (error: Failure | undefined) => void },
  ): () => void;
  // Follows a read or a stream over one WebSocket for all of them, also after lost connections, until the returned function is
  // called. `call`: "docent.v1.Fleet/List". A read is told when its answer has changed, at most each `everyMs`. `onBegun`: nothing that
  // happens from now on is missed.
  follow<I extends DescMessage, O extends DescMessage>(what: {
    call: string;
    input: I;
    request?: MessageInitShape<I>;
    output: O;
    everyMs?: number;
    onBegun?: () => void;
    onMessage: (message: MessageShape<O>) => void;
    onEnd?: (error: Failure | undefined) => void;
  }): () => void;
}

// `address`: "http://127.0.0.1:7480"; in the app of the server itself, location.origin.
export function connectDocent(address: string, options: DocentOptions = {}): Docent {
  const transport =
    options.transport ??
    createConnectTransport({
      baseUrl: address,
      interceptors: options.interceptors ?? [],
      defaultTimeoutMs: options.timeoutMs ?? 30_000,
    });
  const context = createClient(Context, transport);
  const live = new LiveConnection(
    () => new WebSocket(`${address.replace(/^http/, "ws").replace(/\/$/, "")}/live`) as Socket,
  );
  const docent: Docent = {
    context,
    fleet: createClient(Fleet, transport),
    ontologies: createClient(Ontologies, transport),
    replays: createClient(Replays, transport),
    services: createClient(RobotServices, transport),
    workflows: createClient(Workflows, transport),
    tell: (add, { source = "", remove = [], requestId = crypto.randomUUID() } = {}) =>
      context.assert(create(AssertRequestSchema, { requestId, source, add: [...add], remove: [...remove] })),
    select: async (query, signal) => (await read(context, query, signal)).rows,
    ask: async (query, signal) => (await read(context, query, signal)).boolean,
    watch: (
      query,
      onRows,
      {
        everyMs = 0,
        onEnd = (error: Failure | undefined) =>
          error && console.error(`docent: ${error.message ?? error.code}`),
      } = {},
    ) => {
      const answer = new WatchedAnswer();
      return docent.follow({
        call: "docent.v1.Context/Subscribe",
        input: SubscribeRequestSchema,
        request: { query, minIntervalMs: everyMs },
        output: SubscribeReplySchema,
        onEnd,
        onMessage: (reply) => {
          const rows = answer.apply(reply);
          if (rows) onRows(rows);
        },
      });
    },
    follow: ({ call, input, request, output, everyMs, onBegun, onMessage, onEnd }) =>
      live.follow({
        call,
        everyMs,
        ...(onBegun && { onBegun }),
        request: toJson(input, create(input, request)),
        onMessage: (message) => onMessage(fromJson(output, message, { ignoreUnknownFields: true })),
        onEnd: (error) => onEnd?.(error),
      }),
  };
  return docent;
}

async function read(
  context: Client<typeof Context>,
  query: string,
  signal?: AbortSignal,
): Promise<{ rows: Row[]; boolean: boolean }> {
  let variables: readonly string[] = [];
  let boolean = false;
  const rows: Row[] = [];
  for await (const { part } of context.query({ query }, signal ? { signal } : {})) {
    if (part.case === "header") ({ variables, boolean } = part.value);
    else if (part.case === "row")
      rows.push(Object.fromEntries(variables.map((name, i) => [name, valueOf(part.value.values[i])])));
  }
  return { rows, boolean };
}
