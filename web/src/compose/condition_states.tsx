// What is so now of a condition: of each row, and of a whole situation; and what is nearest where it does not hold.
import { Ban, Circle, CircleCheck, CircleDashed, FlaskConical } from "lucide-react";
import { useMemo, useState } from "react";
import { useNames } from "../api/prefixes";
import { shorten } from "../api/sparql";
import { type CawlDocument, type Constraint, prefixesOf } from "../cawl/document";
import type { Sense } from "../cawl/expression";
import { termWords, verbWords } from "../cawl/phrases";
import { useFleet } from "../facts/fleet";
import { TellDialog } from "../facts/tell";
import { tellable } from "../facts/tellable";
import { matchesShown, type Live } from "./live";
import type { Lack, NearestMiss } from "./nearest_miss";
import { patternWords, termName, valuesWords } from "../facts/term_name";

export function count(matches: number): string {
  return matches >= matchesShown
    ? `${matchesShown} or more matches`
    : matches === 1
      ? "1 match"
      : `${matches} matches`;
}

// The state of a whole situation, as icon and words.
export function Chip({ live }: { live: Live | undefined }) {
  if (!live || live.matches < 0)
    return (
      <span className="tag">
        <CircleDashed size={12} />
        not asked
      </span>
    );
  return live.matches > 0 ? (
    <span className="tag good">
      <CircleCheck size={12} />
      true now
    </span>
  ) : (
    <span className="tag wait">
      <Circle size={12} />
      not now
    </span>
  );
}

// `sense`: what the expression of the row's rule says of it; undefined: nothing, and nobody looks at it.
export function RowState({
  live,
  constraint,
  document,
  sense,
}: {
  live: Live | undefined;
  constraint: Constraint;
  document: CawlDocument;
  sense: Sense | undefined;
}) {
  if (!live)
    return (
      <span className="constraint-state faint">
        <CircleDashed size={11} />…
      </span>
    );
  if (live.matches < 0)
    return (
      <span className="constraint-state faint" title={live.note}>
        <CircleDashed size={11} />
        can't be asked
      </span>
    );
  const { good, words } = rowWords(live, constraint, document, sense);
  const Icon = good ? CircleCheck : sense === "must not" ? Ban : Circle;
  const tone = good ? "some" : sense === "must not" || sense === "must" ? "none" : "faint";
  return (
    <span className={`constraint-state ${tone} cut`} title={live.witness || words}>
      <Icon size={11} />
      <span className="cut">{words}</span>
    </span>
  );
}
// Of what must not be, no match is good, and a match may be another one than the rest of the situation means.
export function rowWords(
  live: Live,
  constraint: Constraint,
  document: CawlDocument,
  sense: Sense | undefined,
): { good: boolean; words: string } {
  const match = live.matches > 0 ? matchWords(constraint, live.found) : "";
  const found = `${count(live.matches)}${match && `${live.matches === 1 ? ": " : ", one is "}${match}`}`;
  if (sense === "must not")
    return live.matches > 0
      ? { good: false, words: `must not be: ${found}` }
      : { good: true, words: "no match now, as it must be" };
  if (live.matches > 0) return { good: sense === "must", words: found };
  const [lack] = live.miss?.lacks ?? [];
  return {
    good: false,
    words: `no match now${lack?.now ? `: ${insteadWords(lack, prefixesOf(document))}` : ""}`,
  };
}

// The row with what was found in the places of its variables: "R01 status Standby".
export function matchWords(constraint: Constraint, found: Readonly<Record<string, string>>): string {
  const word = (text: string) => found[text.trim().replace(/^[?$]/, "").replace(".", "_")] ?? termWords(text);
  const free = [constraint.subject.text, constraint.object.text].some((text) => /^[?$]/.test(text.trim()));
  if (!free) return "";
  return [
    /^[?$]/.test(constraint.subject.text.trim())
      ? word(constraint.subject.text)
      : termWords(constraint.subject.text),
    verbWords(constraint.verb.text),
    /^[?$]/.test(constraint.object.text.trim())
      ? word(constraint.object.text)
      : termWords(constraint.object.text),
  ].join(" ");
}
// What is there in place of what is missing: "John is at B10".
function insteadWords({ pattern, now }: Lack, prefixes: ReadonlyMap<string, string>): string {
  const [subject = "", verb = ""] = pattern.split(" ");
  return `${termName(subject, prefixes)} ${verbWords(verb)} ${valuesWords(now, prefixes)}`;
}

// What is nearest to the situation, what is missing, and a way to try it.
export function Miss({ miss, name, document }: { miss: NearestMiss; name: string; document: CawlDocument }) {
  const [telling, setTelling] = useState(false);
  const names = useNames();
  const robots = useFleet();
  const prefixes = useMemo(() => new Map([...names.prefixes, ...prefixesOf(document)]), [names, document]);
  if (miss.lacks.length + miss.tooMuch.length === 0)
    return miss.text ? <p className="situation-lacks small">{miss.text}</p> : null;
  return (
    <div className="situation-lacks" role="status">
      {miss.where && (
        <p>
          Nearest: {miss.where}
          {miss.holds > 0 && (
            <span className="faint">
              {" "}
              ({miss.holds === 1 ? "one fact of it is" : `${miss.holds} facts of it are`} there)
            </span>
          )}
        </p>
      )}
      <ul>
        {miss.lacks.map((lack, i) => (
          <li key={i} title={lack.pattern}>
            missing: <b>{patternWords(lack.pattern, prefixes)}</b>
            {lack.now && <>, now {valuesWords(lack.now, prefixes)}</>}
          </li>
        ))}
        {miss.tooMuch.map((text, i) => (
          <li key={`x${i}`} title={text}>
            must not be: <b>{patternWords(text, prefixes)}</b>
          </li>
        ))}
      </ul>
      <p className="row">
        {miss.add.length > 0 && (
          <button className="button small" onClick={() => setTelling(true)}>
            <FlaskConical size={13} />
            {tellable(miss, robots).length > 0 ? "Simulate or tell" : "Simulate"}
          </button>
        )}
        {miss.others > 0 && (
          <span className="faint small">
            {miss.others === 1 ? "One other way is" : `${miss.others} other ways are`} as near
          </span>
        )}
      </p>
      {telling && (
        <TellDialog
          title={`What is missing for ${name || "the situation"}`}
          quads={miss.add}
          patterns={miss.lacks.map((l) => l.pattern)}
          names={{ ...names, prefixes, short: (iri) => shorten(iri, prefixes), name: names.name }}
          onClose={() => setTelling(false)}
        />
      )}
    </div>
  );
}
