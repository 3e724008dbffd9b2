// A tour as a CAWL document: the booths in the order in which they were chosen, with travel and what is done at each.
import { encodeAttribute, encodeText } from "./xml";

export interface Stop {
  iri: string;
  term: string; // "expo:B03"
  name: string;
  x: number;
  y: number;
}
export interface TourPlan {
  name: string;
  stops: readonly Stop[];
  travel: string; // operation that drives to $booth
  present: readonly string[]; // operations at each stop
  waitForVisitor: boolean; // present only when the visitor is there, too
}

const driveMS = 0.6; // metres a second of a guide robot that is followed by people
const detour = 1.3; // of a way around booths against a straight line
const presentS = 40;

// Estimated seconds: straight ways, lengthened, at a walking robot's speed, and a while at each stop.
export function tourSeconds(stops: readonly Pick<Stop, "x" | "y">[], from: { x: number; y: number } | null): number {
  let metres = 0;
  let at = from;
  for (const stop of stops) {
    if (at) metres += Math.hypot(stop.x - at.x, stop.y - at.y) * detour;
    at = stop;
  }
  return metres / driveMS + stops.length * presentS;
}

function condition(rows: readonly [subject: string, verb: string, object: string, subjectType?: string][], name: string): string {
  const constraints = rows.map(([s, v, o, type], i) => `            <constraint name="c${i + 1}">
              <subject${type ? ` type="${type}"` : ""}>${encodeText(s)}</subject>
              <verb>${v}</verb>
              <object>${encodeText(o)}</object>
            </constraint>`).join("\n");
  return `      <condition>
        <context name="${name}">
          <rule name="rule">
${constraints}
          </rule>
        </context>
      </condition>`;
}

export function tourText(plan: TourPlan, prefixes: ReadonlyMap<string, string>): string {
  const q = (text: string) => encodeAttribute(text);
  const used = new Set(plan.stops.map((s) => s.term.split(":")[0] ?? ""));
  const declared = [...used].filter((p) => p !== "docent").map((p) => `\n      xmlns:${p}="${q(prefixes.get(p) ?? "")}"`).join("");
  const steps = plan.stops.map((stop, i) => ({ ...stop, go: `To ${stop.name}`, at: `At ${stop.name}`, repeated: plan.stops.findIndex((s) => s.name === stop.name) !== i ? ` (${i + 1})` : "" }));
  const nodes = steps.map((s, i) => {
    const robot: [string, string, string, string?][] = i === 0 ? [["?robot", "docent:status", "docent:Standby", "docent:Robot"], ["?robot", "docent:localised", "true"]] : [];
    const arrive = plan.waitForVisitor ? `\n${condition([["$user", "docent:isAt", "$booth"]], "VisitorIsThere")}` : "";
    return `    <node name="${q(s.go + s.repeated)}">
${condition([...robot, ["?booth", "schema:name", JSON.stringify(s.name), "docent:Booth"]], "Next")}
      <invoke operation="${q(plan.travel)}"/>
    </node>
    <node name="${q(s.at + s.repeated)}">${arrive}
${plan.present.map((operation) => `      <invoke operation="${q(operation)}"/>`).join("\n")}
    </node>`;
  }).join("\n\n");
  const names = ["Begin", ...steps.flatMap((s) => [s.go + s.repeated, s.at + s.repeated]), "End"];
  const links = names.slice(1).map((name, i) => `    <link from="${q(names[i] ?? "")}" to="${q(name)}"/>`).join("\n");
  return `<?xml version="1.0" encoding="UTF-8"?>
<CAWL name="${q(plan.name)}" version="1.0"
      xmlns:docent="https://w3id.org/docent#"
      xmlns:schema="https://schema.org/"${declared}>

  <flow name="${q(plan.name)}">
    <documentation>A tour of ${plan.stops.length} stops: ${encodeText(plan.stops.map((s) => s.name).join(", "))}.</documentation>
    <variable name="user" type="docent:Visitor"/>
    <variable name="robot" type="docent:Robot"/>
    <variable name="booth" type="docent:Booth"/>

    <source name="Begin"/>

${nodes}

    <sink name="End"/>

${links}
  </flow>
</CAWL>
`;
}
