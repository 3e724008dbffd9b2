// Before a deployment: for how many visitors, or whatever the activator waits for, its situation holds already.
import { Rocket } from "lucide-react";
import { usePoll } from "../api/poll";
import { query, type Row } from "../api/sparql";
import type { Activator } from "../cawl/document";
import type { CompiledCondition } from "../gen/docent/v1/workflows_pb";

const most = 1000; // matches that are counted

// Of each alternative of the activator a query for its keys: the variables that it declares, else all of the match.
export function keyQueries(
  conditions: readonly CompiledCondition[],
  activator: Pick<Activator, "variables">,
): string[] {
  const keys = activator.variables.map((v) => `?${v.name}`).join(" ") || "*";
  return conditions
    .filter((c) => c.place.startsWith("activator ") && /\bASK\b/.test(c.ask))
    .map((c) => `${c.ask.replace(/\bASK\s*(WHERE\s*)?\{/, `SELECT DISTINCT ${keys} WHERE {`)} LIMIT ${most}`);
}
export function countKeys(answers: readonly (readonly Row[])[]): number {
  const key = (row: Row) =>
    JSON.stringify(
      Object.entries(row)
        .map(([name, value]) => [name, value?.kind, value?.text, value?.language, value?.datatype])
        .sort(),
    );
  return new Set(answers.flatMap((rows) => rows.map(key))).size;
}
// `again`: another version with another condition is deployed; bindings that have started a run start no other.
export function startsWords(count: number, again: boolean): string {
  const fit = `${count >= most ? `${most} or more fit` : count === 1 ? "One fits" : `${count} fit`} now`;
  if (again)
    return `${fit}: ${count === 1 ? "if it has started no run before, Deploy starts one at once." : "Deploy starts a run at once for each that has started none before."}`;
  return `${fit}: Deploy starts ${count === 1 ? "one run" : `${count >= most ? "as many" : count} runs`} at once.`;
}

export function StartsNow({
  activator,
  conditions,
  again,
}: {
  activator: Activator;
  conditions: readonly CompiledCondition[];
  again: boolean;
}) {
  const asks = keyQueries(conditions, activator);
  const counted = usePoll(
    asks.length > 0 ? `starts now ${asks.join("\n")}` : "",
    async (signal) => countKeys(await Promise.all(asks.map(async (ask) => (await query(ask, signal)).rows))),
    3000,
  );
  if (!counted.data) return null;
  return (
    <div className="notice wait" role="status">
      <Rocket size={15} />
      <div>
        <b>{startsWords(counted.data, again)}</b>
      </div>
    </div>
  );
}
