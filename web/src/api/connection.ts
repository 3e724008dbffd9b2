// Whether the server answers, for the badge that says so.
import { createStore } from "./store";

export interface Connection {
  state: "unknown" | "there" | "away";
  since: number; // when it began to be so, in ms since 1970
}
const connection = createStore<Connection>({ state: "unknown", since: Date.now() });

function become(state: Connection["state"]) {
  if (connection.get().state !== state) connection.set({ state, since: Date.now() });
}
export const serverAnswered = () => become("there");
export const serverSilent = () => become("away");

export const useConnection = connection.use;
