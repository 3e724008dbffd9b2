// One WebSocket for all that a tab follows: streams, and reads whose answer is told when it changes. After a lost connection
// each goes on where it was. A change that the server tells in several messages is held until it is whole: the message that
// ends it is the one with `resume`, and what was held is forgotten where the connection is lost before.
import type { JsonValue } from "@bufbuild/protobuf";

export interface Failure {
  code?: string;
  message?: string;
}
export interface Stream {
  call: string; // "docent.v1.Fleet/List"
  request: JsonValue;
  everyMs: number | undefined; // of a read: the least time between two answers
  onBegun?: () => void; // what happens from now on is told; again after each lost connection
  onMessage: (message: JsonValue) => void;
  onEnd: (failure: Failure | undefined) => void;
}
interface Followed extends Stream {
  resume: string;
  places: boolean; // it has told places to resume at
  held: JsonValue[];
}
interface FromServer {
  hello?: unknown;
  id?: number;
  begun?: boolean;
  message?: JsonValue;
  resume?: string;
  end?: { error?: Failure };
  refused?: Failure;
  error?: Failure;
}
export interface Socket {
  readyState: number;
  onmessage: ((event: { data: unknown }) => void) | null;
  onclose: (() => void) | null;
  send: (text: string) => void;
  close: () => void;
}

// opening: there is no connection yet, or it was lost a moment ago; none: the server can't be reached this way
export type LiveState = "opening" | "open" | "none";
export const liveTimes = {
  shortestMs: 250,
  longestMs: 2000,
  withoutMs: 30_000,
  silenceMs: 15_000,
  probeMs: 5000,
  connectMs: 8000,
};
const isOpen = 1;
const probe = { id: 0, call: "docent.v1.Workflows/List" }; // a short answer, which says that the connection lives

export class LiveConnection {
  private socket: Socket | null = null;
  private readonly streams = new Map<number, Followed>();
  private readonly listeners = new Set<() => void>();
  private nextId = 1;
  private pauseMs = liveTimes.shortestMs;
  private greeted = false; // on this socket
  private known = false; // that the server has live connections
  private again: ReturnType<typeof setTimeout> | undefined;
  private silence: ReturnType<typeof setTimeout> | undefined;
  state: LiveState = "opening";

  constructor(
    private readonly open: () => Socket,
    private readonly heard: () => void = () => undefined,
  ) {}

  // Follows a stream or read until the returned function is called.
  follow(stream: Stream): () => void {
    const id = this.nextId++;
    this.streams.set(id, { ...stream, resume: "", places: false, held: [] });
    if (this.state === "open") this.begin(id);
    else this.connect();
    return () => {
      if (this.streams.delete(id)) this.send({ id, end: true });
    };
  }
  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => void this.listeners.delete(listener);
  }
  // The network is back: no need to wait for the next attempt.
  hurry() {
    this.pauseMs = liveTimes.shortestMs;
    this.connect();
  }

  private become(state: LiveState) {
    if (this.state === state) return;
    this.state = state;
    for (const listener of [...this.listeners]) listener();
  }
  private send(message: object) {
    if (this.socket?.readyState === isOpen) this.socket.send(JSON.stringify(message));
  }
  private begin(id: number) {
    const stream = this.streams.get(id);
    if (!stream) return;
    stream.held = [];
    const { call, request, everyMs, resume } = stream;
    this.send({ id, call, request, ...(everyMs !== undefined && { everyMs }), ...(resume && { resume }) });
  }

  private connect() {
    if (this.socket || (this.streams.size === 0 && this.listeners.size === 0)) return;
    clearTimeout(this.again);
    const socket = this.open();
    this.socket = socket;
    this.greeted = false;
    socket.onmessage = (event) => this.receive(JSON.parse(String(event.data)) as FromServer);
    socket.onclose = () => this.lost();
    clearTimeout(this.silence);
    this.silence = setTimeout(() => this.giveUp(), liveTimes.connectMs); // a network may take an hour to say that it is gone
  }
  private giveUp() {
    const socket = this.socket;
    this.lost();
    socket?.close();
  }
  private lost() {
    if (this.socket) this.socket.onmessage = this.socket.onclose = null;
    this.socket = null;
    clearTimeout(this.silence);
    clearTimeout(this.again);
    this.again = setTimeout(() => this.connect(), this.known ? this.pauseMs : liveTimes.withoutMs);
    this.pauseMs = Math.min(this.pauseMs * 2, liveTimes.longestMs);
    this.become(this.greeted ? "opening" : "none"); // a second failure: polling shows what can be shown meanwhile
  }

  // A network that is gone says nothing: after a while the server is asked for a sign of life.
  private listen() {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => {
      this.send(probe);
      this.silence = setTimeout(() => this.giveUp(), liveTimes.probeMs);
    }, liveTimes.silenceMs);
  }

  private receive(message: FromServer) {
    this.listen();
    this.heard();
    if (message.hello !== undefined) {
      this.greeted = this.known = true;
      this.pauseMs = liveTimes.shortestMs;
      this.become("open");
      for (const id of [...this.streams.keys()]) this.begin(id);
      return;
    }
    if (message.id === probe.id && message.message !== undefined) this.send({ id: probe.id, end: true });
    const stream = message.id === undefined ? undefined : this.streams.get(message.id);
    if (!stream || message.id === undefined) return;
    if (message.begun) stream.onBegun?.();
    if (message.message !== undefined) stream.held.push(message.message);
    if (message.resume !== undefined) {
      stream.places = true;
      stream.resume = message.resume;
      this.tell(message.id, stream);
    }
    const failure = message.refused ?? message.error ?? message.end?.error;
    if (!message.end && !failure) return;
    if (!failure || !stream.places) this.tell(message.id, stream); // else it is a part of a change, which comes again
    if (this.streams.delete(message.id)) stream.onEnd(failure);
  }
  private tell(id: number, stream: Followed) {
    for (const message of stream.held.splice(0))
      if (this.streams.get(id) === stream) stream.onMessage(message);
  }
}
