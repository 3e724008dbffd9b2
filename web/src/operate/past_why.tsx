// What a step lacked at the time that is shown: the step is tried on the facts of then.
import { ChevronRight, Unplug } from "lucide-react";
import { useAsOf } from "../api/as_of";
import { replays } from "../api/client";
import type { Names } from "../api/prefixes";
import { query } from "../api/sparql";
import { usePast } from "../api/past";
import { factsOf, factWords } from "../facts/fact_words";

export function PastWhyNot({ run, node, names }: { run: string; node: string; names: Names }) {
  const tried = useAsOf(`lacked ${run}/${node}`, usePast(), async (asOf, signal) => {
    const { revision } = await query("ASK {}", signal, asOf);
    return replays.tryNode({ run, node, turn: revision }, { signal });
  });
  if (tried.error && !tried.data)
    return (
      <p className="notice">
        <Unplug size={14} />
        {tried.error.title}. {tried.error.detail}
      </p>
    );
  if (!tried.data) return <p className="faint small">Looking for what was missing…</p>;
  const lacks = factsOf(tried.data.missing, names);
  if (tried.data.opens) return <p className="notice">It opened with this turn.</p>;
  if (lacks.length === 0) return <p className="faint small">What was missing can’t be told.</p>;
  return (
    <div className="lacks">
      <section className="lack">
        {lacks.map((fact) => (
          <p key={fact} className="lack-words" title={fact}>
            <ChevronRight size={12} />
            <span>{factWords(fact, names.prefixes)}</span>
          </p>
        ))}
      </section>
    </div>
  );
}
