// The newest runs that had to do with a robot, person or booth.
import { useShown } from "../api/as_of";
import { query, type Row } from "../api/sparql";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import { runOf } from "../api/iris";
import { runWords, StateTag, Time } from "../ui/states";

const shown = 6;
export function latelyQuery(iri: string): string {
  const thing = `<${iri.replace(/[<>"{}|^`\\\s]/g, "")}>`;
  return `PREFIX docent: <https://w3id.org/docent#> PREFIX prov: <http://www.w3.org/ns/prov#>
SELECT DISTINCT ?run ?state ?began { GRAPH docent:runs {
  { ?run docent:hasVariable ?v . ?v docent:variableValue ${thing} } UNION { ?run docent:usesRobot ${thing} } UNION { ?i docent:robot ${thing} ; docent:ofNode ?n . ?n docent:ofRun ?run }
  ?run docent:runState ?state ; prov:startedAtTime ?began FILTER NOT EXISTS { ?run docent:parentRun ?parent }
} } ORDER BY DESC(?began) LIMIT ${shown}`;
}
export function readLately(rows: readonly Row[]): { run: string; state: string; beganUs: bigint }[] {
  return rows.flatMap((row) => {
    const began = Date.parse(row["began"]?.text ?? "");
    const run = runOf(row["run"]?.text ?? "");
    return run && Number.isFinite(began)
      ? [{ run, state: row["state"]?.text ?? "", beganUs: BigInt(began) * 1000n }]
      : [];
  });
}

export function Lately({ iri }: { iri: string }) {
  const runs = useShown(
    `lately ${iri}`,
    async (asOf, signal) => readLately((await query(latelyQuery(iri), signal, asOf)).rows),
    3000,
  );
  if (!runs.data || runs.data.length === 0) return null;
  return (
    <>
      <h3>Lately</h3>
      <ul className="lately">
        {runs.data.map((r) => (
          <li key={r.run}>
            <Link href={paths.run(r.run)} className="run-id cut grow">
              {runWords(r.run)}
            </Link>
            <StateTag state={r.state} />
            <Time us={r.beganUs} className="faint small number" />
          </li>
        ))}
      </ul>
    </>
  );
}
