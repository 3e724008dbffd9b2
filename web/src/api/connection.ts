// Whether the server answers, for the badge that says so.
import { useSyncExternalStore } from "react";

export interface Connection {
  state: "unknown" | "there" | "away";
  since: number; // when it began to be so, in ms since 1970
}
let connection: Connection = { state: "unknown", since: Date.now() };
const listeners = new Set<() => void>();

function become(state: Connection["state"]) {
  if (connection.state === state) return;
  connection = { state, since: Date.now() };
  for (const listener of listeners) listener();
}
export const serverAnswered = () => become("there");
export const serverSilent = () => become("away");

export function useConnection(): Connection {
  return useSyncExternalStore(
    (listener) => (listeners.add(listener), () => listeners.delete(listener)),
    () => connection,
  );
}
