// What a tab follows, against a server that is a script: parts of changes, lost connections, servers without live connections.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { LiveConnection, liveTimes, type Failure, type Socket } from "../../../client/src/live_connection";

class ScriptedSocket implements Socket {
  readyState = 1;
  onmessage: Socket["onmessage"] = null;
  onclose: Socket["onclose"] = null;
  sent: Record<string, unknown>[] = [];
  closed = false;
  send(text: string) {
    this.sent.push(JSON.parse(text) as Record<string, unknown>);
  }
  close() {
    this.closed = true;
  }
  say(message: object) {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
  lose() {
    this.readyState = 3;
    this.onclose?.();
  }
}

let sockets: ScriptedSocket[];
let live: LiveConnection;
let told: unknown[];
let ends: (Failure | undefined)[];
const socket = () => sockets.at(-1) as ScriptedSocket;
const follow = () =>
  live.follow({
    call: "docent.v1.Context/Subscribe",
    request: { query: "ASK {}" },
    everyMs: undefined,
    onMessage: (m) => told.push(m),
    onEnd: (e) => ends.push(e),
  });

beforeEach(() => {
  vi.useFakeTimers();
  sockets = [];
  told = [];
  ends = [];
  live = new LiveConnection(() => {
    sockets.push(new ScriptedSocket());
    return socket();
  });
});
afterEach(() => void vi.useRealTimers());

describe("parts of a change", () => {
  it("are held until the message with resume, and come in order", () => {
    follow();
    socket().say({ hello: {} });
    socket().say({ id: 1, begun: true, resume: "0" });
    socket().say({ id: 1, message: { part: 1 } });
    socket().say({ id: 1, message: { part: 2 } });
    expect(told).toEqual([]);
    socket().say({ id: 1, message: { part: 3 }, resume: "a" });
    expect(told).toEqual([{ part: 1 }, { part: 2 }, { part: 3 }]);
  });
  it("are forgotten where the connection is lost, and the change comes whole from its beginning", () => {
    follow();
    socket().say({ hello: {} });
    socket().say({ id: 1, message: { whole: 1 }, resume: "a" });
    socket().say({ id: 1, message: { part: 1 } });
    socket().lose();
    vi.advanceTimersByTime(liveTimes.longestMs);
    socket().say({ hello: {} });
    expect(socket().sent).toEqual([
      { id: 1, call: "docent.v1.Context/Subscribe", request: { query: "ASK {}" }, resume: "a" },
    ]);
    socket().say({ id: 1, message: { part: 1 } });
    socket().say({ id: 1, message: { part: 2 }, resume: "b" });
    expect(told).toEqual([{ whole: 1 }, { part: 1 }, { part: 2 }]);
  });
  it("are forgotten where the stream fails", () => {
    follow();
    socket().say({ hello: {} });
    socket().say({ id: 1, message: { whole: 1 }, resume: "a" });
    socket().say({ id: 1, message: { part: 1 } });
    socket().say({ id: 1, end: { error: { code: "resource_exhausted" } } });
    expect(told).toEqual([{ whole: 1 }]);
    expect(ends).toEqual([{ code: "resource_exhausted" }]);
  });
  it("a stream that has no places comes whole with its end", () => {
    follow();
    socket().say({ hello: {} });
    socket().say({ id: 1, message: { row: 1 } });
    socket().say({ id: 1, message: { row: 2 } });
    socket().say({ id: 1, end: {} });
    expect(told).toEqual([{ row: 1 }, { row: 2 }]);
    expect(ends).toEqual([undefined]);
  });
  it("nothing comes after the tab has ended it, not even the rest of a change", () => {
    const stop = live.follow({
      call: "x/y",
      request: {},
      everyMs: undefined,
      onMessage: (m) => (told.push(m), stop()),
      onEnd: () => undefined,
    });
    socket().say({ hello: {} });
    socket().say({ id: 1, message: { part: 1 } });
    socket().say({ id: 1, message: { part: 2 }, resume: "a" });
    expect(told).toEqual([{ part: 1 }]);
    expect(socket().sent.at(-1)).toEqual({ id: 1, end: true });
  });
  it("an empty place is one too: it begins at the beginning", () => {
    follow();
    socket().say({ hello: {} });
    socket().say({ id: 1, message: { whole: 1 }, resume: "" });
    expect(told).toEqual([{ whole: 1 }]);
  });
});

describe("the connection", () => {
  it("comes back within two seconds after a server that was away for long", () => {
    follow();
    socket().say({ hello: {} });
    socket().lose();
    for (let i = 0; i < 40; i++) {
      vi.advanceTimersByTime(liveTimes.longestMs);
      socket().lose();
    }
    expect(live.state).toBe("none");
    const before = sockets.length;
    vi.advanceTimersByTime(liveTimes.longestMs);
    expect(sockets.length).toBe(before + 1);
    socket().say({ hello: {} });
    expect(live.state).toBe("open");
  });
  it("comes back also where the views have gone over to polling meanwhile", () => {
    live.subscribe(() => undefined);
    const stop = follow();
    socket().say({ hello: {} });
    socket().lose();
    vi.advanceTimersByTime(liveTimes.longestMs);
    socket().lose();
    stop();
    vi.advanceTimersByTime(liveTimes.longestMs);
    socket().say({ hello: {} });
    expect(live.state).toBe("open");
  });
  it("is tried seldom where the server never had it", () => {
    live.subscribe(() => undefined);
    follow();
    socket().lose();
    expect(live.state).toBe("none");
    vi.advanceTimersByTime(liveTimes.withoutMs - 1);
    expect(sockets.length).toBe(1);
    vi.advanceTimersByTime(2);
    expect(sockets.length).toBe(2);
  });
  it("that says nothing any more is given up, and another one is opened", () => {
    follow();
    socket().say({ hello: {} });
    vi.advanceTimersByTime(liveTimes.silenceMs);
    expect(socket().sent.at(-1)).toEqual({ id: 0, call: "docent.v1.Workflows/List" });
    const silent = socket();
    vi.advanceTimersByTime(liveTimes.probeMs);
    expect(silent.closed).toBe(true);
    vi.advanceTimersByTime(liveTimes.longestMs);
    expect(sockets.length).toBe(2);
  });
  it("that does not come about is given up, and tried again", () => {
    follow();
    vi.advanceTimersByTime(liveTimes.connectMs);
    expect(socket().closed).toBe(true);
    expect(live.state).toBe("none");
    live.hurry();
    expect(sockets.length).toBe(2);
  });
  it("that answers the question for a sign of life stays", () => {
    follow();
    socket().say({ hello: {} });
    vi.advanceTimersByTime(liveTimes.silenceMs);
    socket().say({ id: 0, message: {}, resume: "x" });
    expect(socket().sent.at(-1)).toEqual({ id: 0, end: true });
    vi.advanceTimersByTime(liveTimes.probeMs + 1000);
    expect(sockets.length).toBe(1);
  });
});
