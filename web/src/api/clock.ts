// The server's time against this browser's: another machine may have another one, and a simulated one runs as it is told.
import { serverIsAhead } from "./past";
import { usePoll } from "./poll";
import { query } from "./sparql";

export function useServerClock() {
  usePoll(
    "clock",
    async (signal) => {
      const { rows } = await query("SELECT (NOW() AS ?now) {}", signal);
      const now = Date.parse(rows[0]?.["now"]?.text ?? "");
      if (Number.isFinite(now)) serverIsAhead(now - Date.now());
      return now;
    },
    5000,
  );
}
