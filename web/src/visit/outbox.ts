// What the visitor tells, until the server has it: kept in this browser, sent in order, sent again after a failure. Each
// telling has an id, so that the server takes it once.
import { createStore } from "../api/store";
import { fromJson, toJson, type JsonValue } from "@bufbuild/protobuf";
import { type AssertRequest, AssertRequestSchema } from "../gen/docent/v1/context_pb";
import type { PlainError } from "../api/errors";
import type { Kept } from "../api/storage";

export type OutboxState =
  { kind: "empty" } | { kind: "sending" } | { kind: "unsent" } | { kind: "refused"; reason: string };
export interface OutboxPorts {
  storage: Pick<Kept, "getItem"> & { setItem(key: string, value: string): unknown };
  send: (request: AssertRequest) => Promise<unknown>;
  plain: (error: unknown) => PlainError;
}
const key = "docent.visit.outbox";
const pausesMs = [500, 1000, 2000, 4000, 8000];

export class Outbox {
  private waiting: AssertRequest[];
  private busy = false;
  private failures = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  readonly states = createStore<OutboxState>({ kind: "empty" });

  constructor(private readonly ports: OutboxPorts) {
    this.waiting = this.read();
    if (this.waiting.length > 0) this.become({ kind: "sending" });
  }
  get state(): OutboxState {
    return this.states.get();
  }

  put(request: AssertRequest) {
    this.waiting.push(request);
    this.keep();
    this.become({ kind: "sending" });
    void this.flush();
  }
  // Sends what waits, now.
  async flush() {
    clearTimeout(this.timer);
    if (this.busy) return;
    this.busy = true;
    for (let next = this.waiting[0]; next; next = this.waiting[0]) {
      try {
        await this.ports.send(next);
        this.failures = 0;
      } catch (error) {
        const { kind, title, detail } = this.ports.plain(error);
        if (kind !== "refused") {
          this.become({ kind: "unsent" });
          this.timer = setTimeout(
            () => void this.flush(),
            pausesMs[Math.min(this.failures++, pausesMs.length - 1)],
          );
          this.busy = false;
          return;
        }
        this.waiting = [];
        this.keep();
        this.busy = false;
        return this.become({ kind: "refused", reason: detail || title });
      }
      this.waiting.shift();
      this.keep();
    }
    this.busy = false;
    this.become({ kind: "empty" });
  }

  private become(state: OutboxState) {
    this.states.set(state);
  }
  private keep() {
    this.ports.storage.setItem(
      key,
      JSON.stringify(this.waiting.map((request) => toJson(AssertRequestSchema, request))),
    );
  }
  private read(): AssertRequest[] {
    try {
      const stored = JSON.parse(this.ports.storage.getItem(key) ?? "[]") as JsonValue;
      return Array.isArray(stored) ? stored.map((one) => fromJson(AssertRequestSchema, one)) : [];
    } catch {
      return [];
    }
  }
}
