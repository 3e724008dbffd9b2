// How many runs wait for something, or for a robot that is offline, in the menu.
import { usePoll } from "../api/poll";
import { query } from "../api/sparql";

const countQuery = `PREFIX docent: <https://w3id.org/docent#>
SELECT (COUNT(DISTINCT ?run) AS ?n) { GRAPH docent:runs { ?run docent:runState "running" . ?node docent:ofRun ?run
  { ?node docent:nodeState "waiting" } UNION { ?node docent:nodeState "incident" } UNION { ?i docent:ofNode ?node ; docent:invocationState "pending" } UNION { ?i docent:ofNode ?node ; docent:invocationState "running" ; docent:robot ?robot . FILTER EXISTS { GRAPH ?robot { ?robot docent:status docent:Offline } } } } }`;

export function WaitingCount() {
  const polled = usePoll(
    "waiting count",
    async (signal) => Number((await query(countQuery, signal)).rows[0]?.["n"]?.text ?? 0),
    3000,
  );
  return polled.data ? (
    <span className="rail-count" aria-label={`${polled.data} waiting`}>
      {polled.data > 99 ? "99+" : polled.data}
    </span>
  ) : null;
}
