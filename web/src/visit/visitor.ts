// The visitor of this browser: a random number, where it is, what it has chosen. All of it is told to the server as facts of a
// source of its own.
import { createStore } from "../api/store";
import { create } from "@bufbuild/protobuf";
import { context, workflows } from "../api/client";
import { plain } from "../api/errors";
import { randomUuid } from "../api/ids";
import { kept } from "../api/storage";
import { iriTerm } from "../api/terms";
import { type AssertRequest, AssertRequestSchema } from "../gen/docent/v1/context_pb";
import { type Quad, QuadSchema, type Term, TermSchema } from "../gen/docent/v1/term_pb";
import { docentNs } from "./offers";
import { Outbox } from "./outbox";

export interface Visitor {
  id: string; // IRI
  at: string; // IRIs; empty: not known
  service: string;
  booth: string;
  asked: boolean; // the robot is called
  run: string; // the newest run of the visitor that is known
  past: string; // the run before, which the visitor is done with
  met: string; // the run in which the robot has been with the visitor
  rated: string; // the run that feedback was given of
  toldMs: number; // when the wish was told last, or again; 0: it is not told
}
const key = "docent.visit";
const livesMs = 12 * 3_600_000; // of what is told, after which the server forgets it
// A wish lasts as long as its page tells it again: of a page that is closed it ends by itself, and starts nothing later.
export const wishLivesMs = 30 * 60_000;
export const wishAgainMs = 5 * 60_000;
const rdfType = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";
const fresh = (): Visitor => ({
  id: `urn:uuid:${randomUuid()}`,
  at: "",
  service: "",
  booth: "",
  asked: false,
  run: "",
  past: "",
  met: "",
  rated: "",
  toldMs: 0,
});

function read(): Visitor {
  try {
    const stored = JSON.parse(kept.getItem(key) ?? "null") as Partial<Visitor> | null;
    // Of a page before this version: told for 12 hours, and to be withdrawn all the same.
    return typeof stored?.id === "string"
      ? { ...fresh(), ...(stored.asked && { toldMs: Date.now() }), ...stored }
      : fresh();
  } catch {
    return fresh();
  }
}
const store = createStore(read());
export const outbox = new Outbox({ storage: kept, send, plain });
async function send(request: AssertRequest) {
  await context.assert(request, { timeoutMs: 10_000 });
  // One that was kept for want of a network lasts from now on.
  if (request.add.some((quad) => quad.predicate?.kind.value === `${docentNs}chose`))
    change({ toldMs: Date.now() });
}
window.addEventListener("online", () => void outbox.flush());
void outbox.flush();

export function change(values: Partial<Visitor>) {
  const visitor = { ...store.get(), ...values };
  kept.setItem(key, JSON.stringify(visitor));
  store.set(visitor);
}
export const useVisitor = store.use;
export const useOutbox = outbox.states.use;

const literal = (lexical: string, datatype = "", language = ""): Term =>
  create(TermSchema, { kind: { case: "literal", value: { lexical, datatype, language } } });
const fact = (subject: string, property: string, object: Term | string): Quad =>
  create(QuadSchema, {
    subject: iriTerm(subject),
    predicate: iriTerm(property.includes(":") ? property : docentNs + property),
    object: typeof object === "string" ? iriTerm(object) : object,
  });
function tell(add: Quad[], remove: Quad[] = [], lifetimeMs = livesMs) {
  if (add.length + remove.length > 0)
    outbox.put(
      create(AssertRequestSchema, {
        requestId: randomUuid(),
        source: store.get().id,
        add,
        remove,
        ...(add.length > 0 && { lifetimeMs: BigInt(lifetimeMs) }),
      }),
    );
}
const wish = (service: string) => tell([fact(store.get().id, "chose", service)], [], wishLivesMs);

// "Guest 4F2A", for those who look at the hall.
export function guestName(id: string): string {
  return `Guest ${id.slice(-4).toUpperCase()}`;
}

export function arrive(place: string) {
  const visitor = store.get();
  const before = visitor.at;
  change({ at: place });
  if (visitor.asked && before !== place) tell([fact(visitor.id, "isAt", place)]);
}
export function call(service: string, booth: string) {
  const { id, at, run, past } = store.get();
  change({
    service,
    booth,
    asked: true,
    past: run || past,
    run: "",
    met: "",
    toldMs: Date.now(),
  });
  tell([
    fact(id, rdfType, `${docentNs}Visitor`),
    fact(id, "http://www.w3.org/2000/01/rdf-schema#label", literal(guestName(id))),
    ...(at ? [fact(id, "isAt", at)] : []),
    ...(booth ? [fact(id, "selected", booth)] : []),
  ]);
  wish(service); // after what its run may need
}
// While the page is open, the wish is told again before its lifetime ends. One whose lifetime has ended is not: that would start another run.
export function renewWish() {
  const visitor = store.get();
  const { asked, service, toldMs } = visitor;
  const now = Date.now();
  if (
    !asked ||
    !service ||
    outbox.state.kind !== "empty" ||
    now - toldMs < wishAgainMs ||
    lapsed(visitor, now)
  )
    return;
  change({ toldMs: now });
  wish(service);
}
export function lapsed(v: Pick<Visitor, "toldMs">, now: number): boolean {
  return now - v.toldMs >= wishLivesMs;
}
export function select(booth: string) {
  change({ booth });
  tell([fact(store.get().id, "selected", booth)]);
}
// What was wished is no longer told; the page may still show how it went.
export function fulfilled() {
  const { id, service, booth, asked, toldMs } = store.get();
  if (!asked || toldMs === 0) return;
  change({ toldMs: 0 });
  tell(
    [],
    [...(service ? [fact(id, "chose", service)] : []), ...(booth ? [fact(id, "selected", booth)] : [])],
  );
}
// The next wish is another one.
export function withdraw() {
  const { asked, run, past } = store.get();
  if (!asked) return;
  fulfilled();
  change({ asked: false, past: run || past, run: "" });
}
// Ends the run as well, as soon as there is a network.
export async function end(): Promise<void> {
  const { run } = store.get();
  withdraw();
  for (let pauseMs = 1000; run !== ""; pauseMs = Math.min(pauseMs * 2, 15_000)) {
    try {
      await workflows.cancel({ run, reason: "the visitor ended it" }, { timeoutMs: 10_000 });
      return;
    } catch (error) {
      if (!["away", "failed"].includes(plain(error).kind)) return; // it has ended by itself
      await new Promise((done) => setTimeout(done, pauseMs));
    }
  }
}
export function rate(run: string, stars: number, text: string, language: string) {
  const id = `urn:uuid:${randomUuid()}`;
  const visitor = store.get();
  change({ rated: run });
  outbox.put(
    create(AssertRequestSchema, {
      requestId: randomUuid(),
      source: visitor.id,
      add: [
        fact(id, rdfType, `${docentNs}Feedback`),
        fact(id, "rating", literal(String(stars), "http://www.w3.org/2001/XMLSchema#integer")),
        fact(id, "givenBy", visitor.id),
        fact(id, "ofService", visitor.service),
        ...(run ? [fact(id, "feedbackOn", `urn:docent:run:${run}`)] : []),
        ...(text.trim() ? [fact(id, "comment", literal(text.trim().slice(0, 2000), "", language))] : []),
      ],
    }),
  );
}
