// One WebSocket a tab for all that it follows: streams and reads, resumed where they were after a lost connection. A server
// that has no /live is asked by polling instead.
import { fromJson, type DescMessage, type JsonValue, type MessageShape } from "@bufbuild/protobuf";
import { useEffect, useRef, useState } from "react";
import { serverAnswered } from "./connection";
import { plain, type PlainError } from "./errors";
import { type Polled, usePoll } from "./poll";
import { ConnectError } from "@connectrpc/connect";

interface Stream {
  call: string;
  request: JsonValue;
  everyMs: number | undefined;
  resume: string;
  onMessage: (message: JsonValue) => void;
  onEnd: (error: { code?: string; message?: string } | undefined) => void;
}
interface FromServer {
  hello?: unknown;
  id?: number;
  message?: JsonValue;
  resume?: string;
  end?: { error?: { code?: string; message?: string } };
  refused?: { code?: string; message?: string };
  error?: { code?: string; message?: string };
}

type State = "opening" | "open" | "none";
const retryMs = { shortest: 250, longest: 2000, without: 30_000 };

class Live {
  private socket: WebSocket | null = null;
  private readonly streams = new Map<number, Stream>();
  private readonly listeners = new Set<() => void>();
  private nextId = 1;
  private pause = retryMs.shortest;
  private greeted = false;
  state: State = "opening";

  // Follows a stream or read until the returned function is called.
  follow(stream: Omit<Stream, "resume">): () => void {
    const id = this.nextId++;
    this.streams.set(id, { ...stream, resume: "" });
    if (this.socket?.readyState === WebSocket.OPEN && this.state === "open") this.begin(id);
    else this.connect();
    return () => {
      if (this.streams.delete(id) && this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ id, end: true }));
    };
  }
  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => void this.listeners.delete(listener);
  }

  private become(state: State) {
    if (this.state === state) return;
    this.state = state;
    for (const listener of this.listeners) listener();
  }

  private begin(id: number) {
    const stream = this.streams.get(id);
    if (!stream) return;
    const { call, request, everyMs, resume } = stream;
    this.socket?.send(JSON.stringify({ id, call, request, ...(everyMs !== undefined && { everyMs }), ...(resume && { resume }) }));
  }

  connect() {
    if (this.socket || this.streams.size === 0) return;
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live`);
    this.socket = socket;
    this.greeted = false;
    socket.onmessage = (event) => this.receive(JSON.parse(String(event.data)) as FromServer);
    socket.onclose = () => {
      this.socket = null;
      // A connection that was never greeted: this server has no /live, or is not there. Polling finds out which.
      if (!this.greeted) this.become("none");
      window.setTimeout(() => this.connect(), this.greeted || this.state === "open" ? this.pause : retryMs.without);
      this.pause = Math.min(this.pause * 2, retryMs.longest);
      if (this.greeted) this.become("opening");
    };
  }

  private receive(message: FromServer) {
    if (message.hello !== undefined) {
      this.greeted = true;
      this.pause = retryMs.shortest;
      this.become("open");
      serverAnswered();
      for (const id of this.streams.keys()) this.begin(id);
      return;
    }
    const stream = message.id === undefined ? undefined : this.streams.get(message.id);
    if (!stream || message.id === undefined) return;
    if (message.message !== undefined) stream.onMessage(message.message);
    if (message.resume) stream.resume = message.resume;
    const failed = message.refused ?? message.error ?? message.end?.error;
    if (message.end || failed) {
      this.streams.delete(message.id);
      stream.onEnd(failed);
    }
  }
}

export const live = new Live();

function useLiveState(): State {
  const [state, setState] = useState<State>(live.state);
  useEffect(() => live.subscribe(() => setState(live.state)), []);
  return state;
}

// A read that is followed: by /live where the server has it, else by polling. An empty key follows nothing.
export function useFollow<D extends DescMessage>(key: string, what: { call: string; request: JsonValue; reply: D; poll: (signal: AbortSignal) => Promise<MessageShape<D>>; everyMs: number }): Polled<MessageShape<D>> {
  const state = useLiveState();
  const latest = useRef(what);
  latest.current = what;
  const [followed, setFollowed] = useState<{ key: string; data?: MessageShape<D>; error?: PlainError }>({ key });
  useEffect(() => {
    if (key === "" || state === "none") return;
    const { call, request, reply, everyMs } = latest.current;
    return live.follow({
      call, request, everyMs,
      onMessage: (message) => setFollowed({ key, data: fromJson(reply, message, { ignoreUnknownFields: true }) }),
      onEnd: (error) => error && setFollowed((before) => ({ ...(before.key === key ? before : { key }), error: plainOf(error) })),
    });
  }, [key, state === "none"]);
  const mine = followed.key === key ? followed : undefined;
  const polled = usePoll(state === "none" || mine?.error ? key : "", what.poll, Math.max(500, what.everyMs));
  const data = state === "none" ? (polled.data ?? mine?.data) : (mine?.data ?? polled.data);
  return { data, error: polled.error ?? (polled.data ? undefined : mine?.error), again: polled.again };
}

function plainOf(error: { code?: string; message?: string }): PlainError {
  const code = { not_found: 5, unimplemented: 12, invalid_argument: 3, failed_precondition: 9, out_of_range: 11, resource_exhausted: 8 }[error.code ?? ""] ?? 2;
  return plain(new ConnectError(error.message ?? "", code));
}
