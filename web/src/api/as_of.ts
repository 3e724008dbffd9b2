// What was so at a time of the past. While the time is dragged, one question is on its way at a time and what was answered last
// stays shown; the newest time wins.
import { useEffect, useRef, useState } from "react";
import { timeText, usePast } from "./past";
import { plain } from "./errors";
import { type Polled, usePoll } from "./poll";

// `atMs` null, or an empty key, asks nothing.
export function useAsOf<T>(
  key: string,
  atMs: number | null,
  ask: (asOf: string, signal: AbortSignal) => Promise<T>,
): Polled<T> & { loading: boolean } {
  const [state, setState] = useState<{
    key: string;
    atMs: number | null;
    data?: T;
    error?: Polled<T>["error"];
  }>({ key: "", atMs: null });
  const latest = useRef({ key, atMs, ask });
  latest.current = { key, atMs, ask };
  const running = useRef<AbortController | null>(null);
  const turn = useRef<() => Promise<void>>(() => Promise.resolve());
  turn.current = async () => {
    const wanted = latest.current;
    if (running.current || wanted.key === "" || wanted.atMs === null) return;
    const abort = (running.current = new AbortController());
    try {
      const data = await wanted.ask(timeText(wanted.atMs), abort.signal);
      if (!abort.signal.aborted) setState({ key: wanted.key, atMs: wanted.atMs, data });
    } catch (error) {
      const words = plain(error);
      if (!abort.signal.aborted)
        setState((before) => ({
          ...(before.key === wanted.key ? before : { key: wanted.key }),
          atMs: wanted.atMs,
          error: words,
        }));
    }
    if (running.current === abort) running.current = null;
    if (!abort.signal.aborted && (latest.current.key !== wanted.key || latest.current.atMs !== wanted.atMs))
      void turn.current();
  };
  useEffect(() => void turn.current(), [key, atMs]);
  useEffect(
    () => () => {
      running.current?.abort();
      running.current = null;
    },
    [],
  );
  const mine = state.key === key && key !== "" && atMs !== null;
  return {
    data: mine ? state.data : undefined,
    error: mine ? state.error : undefined,
    again: () => void turn.current(),
    loading: atMs !== null && state.atMs !== atMs,
  };
}

// What is shown while an answer for another time is on its way: the last one of the same key.
export function useKept<T>(key: string, polled: Polled<T>): Polled<T> {
  const kept = useRef<{ key: string; data: T | undefined }>({ key, data: undefined });
  if (kept.current.key !== key) kept.current = { key, data: undefined };
  if (polled.data !== undefined) kept.current.data = polled.data;
  return polled.data === undefined ? { ...polled, data: kept.current.data } : polled;
}

// What is asked again and again of now, or once of the time that is shown.
export function useShown<T>(
  key: string,
  ask: (asOf: string, signal: AbortSignal) => Promise<T>,
  everyMs: number,
): Polled<T> {
  const at = usePast();
  const now = usePoll(at === null ? key : "", (signal) => ask("", signal), everyMs);
  const then = useAsOf(key, at, ask);
  return useKept(key, at === null ? now : then);
}
