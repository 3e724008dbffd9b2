// What the tab follows, for views: over one WebSocket (live_connection.ts). A server that has no /live is asked by polling
// instead.
import { fromJson, type DescMessage, type JsonValue, type MessageShape } from "@bufbuild/protobuf";
import { useEffect, useRef, useState, useSyncExternalStore } from "react";
import { serverAnswered } from "./connection";
import { plain, type PlainError } from "./errors";
import { LiveConnection, type Failure, type LiveState, type Socket } from "../../client/src/live_connection";
import { type Polled, usePoll } from "./poll";
import { ConnectError } from "@connectrpc/connect";

export const live = new LiveConnection(
  () => new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live`) as Socket,
  serverAnswered,
);
if (typeof window !== "undefined") window.addEventListener("online", () => live.hurry());

const subscribeLive = (listener: () => void) => live.subscribe(listener);
function useLiveState(): LiveState {
  return useSyncExternalStore(subscribeLive, () => live.state);
}

const unseenMs = 2000; // a hidden tab gets updates less often

function useSeen(): boolean {
  return useSyncExternalStore(
    (changed) => {
      document.addEventListener("visibilitychange", changed);
      return () => document.removeEventListener("visibilitychange", changed);
    },
    () => document.visibilityState !== "hidden",
  );
}

// A read that is followed: by /live where the server has it, else by polling. An empty key follows nothing.
export function useFollow<D extends DescMessage>(
  key: string,
  what: {
    call: string;
    request: JsonValue;
    reply: D;
    poll: (signal: AbortSignal) => Promise<MessageShape<D>>;
    everyMs: number;
  },
): Polled<MessageShape<D>> {
  const state = useLiveState();
  const none = state === "none";
  const latest = useRef(what);
  latest.current = what;
  const seen = useSeen();
  const [followed, setFollowed] = useState<{ key: string; data?: MessageShape<D>; error?: PlainError }>({
    key,
  });
  useEffect(() => {
    if (key === "" || none) return;
    const { call, request, reply, everyMs } = latest.current;
    return live.follow({
      call,
      request,
      everyMs: seen ? everyMs : Math.max(everyMs, unseenMs),
      onMessage: (message) =>
        setFollowed({ key, data: fromJson(reply, message, { ignoreUnknownFields: true }) }),
      onEnd: (error) =>
        error &&
        setFollowed((before) => ({ ...(before.key === key ? before : { key }), error: plainOf(error) })),
    });
  }, [key, none, seen]);
  const mine = followed.key === key ? followed : undefined;
  const polled = usePoll(none || mine?.error ? key : "", what.poll, Math.max(500, what.everyMs));
  const data = none ? (polled.data ?? mine?.data) : (mine?.data ?? polled.data);
  return { data, error: polled.error ?? (polled.data ? undefined : mine?.error), again: polled.again };
}

function plainOf(error: Failure): PlainError {
  const code =
    {
      not_found: 5,
      unimplemented: 12,
      invalid_argument: 3,
      failed_precondition: 9,
      out_of_range: 11,
      resource_exhausted: 8,
    }[error.code ?? ""] ?? 2;
  return plain(new ConnectError(error.message ?? "", code));
}
