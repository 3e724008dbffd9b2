// A tour as a CAWL document: the booths in the order in which they were chosen, with travel and what is done at each.
import { encodeAttribute, encodeText } from "./xml";

export interface Stop {
  iri: string;
  term: string; // "expo:B03"
  name: string;
  x: number;
  y: number;
  present?: readonly string[]; // operations here, in place of those of the whole tour
  say?: string; // spoken here, before the rest
}
export interface TourPlan {
  name: string;
  stops: readonly Stop[];
  travel: string; // operation that drives to $booth
  present: readonly string[]; // operations at each stop
  waitForVisitor: boolean; // present only when the visitor is there, too
  stayNear?: boolean; // drive only while the visitor is near: the robot waits for who falls behind
  speak?: string; // operation that speaks $text
}

// What a tour can be made of: steps that are known, with the values that they take.
export interface TourOffer {
  kind: "operation" | "service" | "workflow";
  id: string;
  title: string;
  inputs: readonly { name: string; type: string }[];
  uses?: readonly string[]; // of a service: what it is made of
}
export interface TourChoices<O extends TourOffer> {
  travel: O[]; // that can drive to a booth
  at: O[]; // that can be done at one
  travelBy: string; // chosen at first
  present: string[]; // chosen at first: each thing once
  speak: string; // that says a text; empty: nothing does
}
const drives = /move|drive|go|navigat|guide|lead|walk|bring/i;
const presents = /info|brief|display|present|say|show|tell|explain/i;

export function tourChoices<O extends TourOffer>(entries: readonly O[], travel = ""): TourChoices<O> {
  const offers = entries.filter((e) => e.kind !== "workflow");
  const withBooth = offers.filter((e) => e.inputs.some((i) => i.name === "booth"));
  const atBooth = withBooth.length > 0 ? withBooth : offers; // robots that do not say what their operations take
  const driving = atBooth.filter((e) => drives.test(e.id));
  const fitting = driving.length > 0 ? driving : atBooth;
  const travelBy =
    travel ||
    ([/move.*booth|drive.*booth|goto/i, /drive|move|go/i]
      .map((pattern) => fitting.find((e) => pattern.test(e.id)))
      .find((e) => e !== undefined)?.id ??
      "");
  const at = atBooth.filter((e) => e.id !== travelBy && !(withBooth.length > 0 && driving.includes(e)));
  // A service and the operation that it is made of are one thing.
  const inServices = new Set(offers.filter((e) => e.kind === "service").flatMap((e) => e.uses ?? []));
  const speaks = offers.filter((e) => e.inputs.some((i) => i.name === "text"));
  return {
    travel: fitting,
    at,
    travelBy,
    present: withBooth
      .filter(
        (e) => at.includes(e) && presents.test(e.id) && !(e.kind === "operation" && inServices.has(e.id)),
      )
      .map((e) => e.id),
    speak:
      (
        speaks.find((e) => e.id === "say") ??
        speaks.find((e) => /^(say|speak|announce)/i.test(e.id)) ??
        offers.find((e) => e.id === "say" && e.inputs.length === 0)
      )?.id ?? "",
  };
}

const driveMS = 0.6; // metres a second of a guide robot that is followed by people
const detour = 1.3; // of a way around booths against a straight line
export const presentS = 25;
const spokenPerS = 14; // characters

// Estimated seconds: the ways at a walking robot's speed, and a while at each stop. `metres`: of each way, where the hall's routes
// tell; else straight ways, lengthened.
export function tourSeconds(
  stops: readonly Pick<Stop, "x" | "y" | "say">[],
  from: { x: number; y: number } | null,
  metres: readonly (number | undefined)[] = [],
): number {
  let way = 0;
  let spoken = 0;
  let at = from;
  stops.forEach((stop, i) => {
    if (at) way += metres[i] ?? Math.hypot(stop.x - at.x, stop.y - at.y) * detour;
    spoken += (stop.say?.length ?? 0) / spokenPerS;
    at = stop;
  });
  return way / driveMS + spoken + stops.length * presentS;
}

function condition(
  rows: readonly [subject: string, verb: string, object: string, subjectType?: string][],
  name: string,
): string {
  const constraints = rows
    .map(
      ([s, v, o, type], i) => `            <constraint name="c${i + 1}">
              <subject${type ? ` type="${type}"` : ""}>${encodeText(s)}</subject>
              <verb>${v}</verb>
              <object>${encodeText(o)}</object>
            </constraint>`,
    )
    .join("\n");
  return `      <condition>
        <context name="${name}">
          <rule name="rule">
${constraints}
          </rule>
        </context>
      </condition>`;
}

// SPARQL 1.1, section 19.7: a string in quotes, on one line.
const sparqlText = (text: string) => `'${text.replace(/\s+/g, " ").replace(/[\\']/g, "\\$&")}'`;

export function tourText(plan: TourPlan, prefixes: ReadonlyMap<string, string>): string {
  const q = (text: string) => encodeAttribute(text);
  const used = new Set(plan.stops.map((s) => s.term.split(":")[0] ?? ""));
  const declared = [...used]
    .filter((p) => p !== "docent")
    .map((p) => `\n      xmlns:${p}="${q(prefixes.get(p) ?? "")}"`)
    .join("");
  const steps = plan.stops.map((stop, i) => ({
    ...stop,
    go: `To ${stop.name}`,
    at: `At ${stop.name}`,
    repeated: plan.stops.findIndex((s) => s.name === stop.name) !== i ? ` (${i + 1})` : "",
  }));
  const said = plan.speak && plan.stops.some((s) => s.say?.trim());
  const nodes = steps
    .map((s, i) => {
      const robot: [string, string, string, string?][] =
        i === 0
          ? [
              ["?robot", "docent:status", "docent:Standby", "docent:Robot"],
              ["?robot", "docent:localised", "true"],
            ]
          : [];
      const arrive = plan.waitForVisitor
        ? `\n${condition([["$user", "docent:isAt", "$booth"]], "VisitorIsThere")}`
        : "";
      const speaks = plan.speak && s.say?.trim();
      const text = speaks ? `<ext:input part="text" expression="${q(sparqlText(speaks))}"/>` : "";
      const there = [...(speaks ? [plan.speak ?? ""] : []), ...(s.present ?? plan.present)];
      return `    <node name="${q(s.go + s.repeated)}"${plan.stayNear && i > 0 ? ' ext:while-holds="$user docent:isNear $robot"' : ""}>
${condition([...robot, ["?booth", "schema:name", JSON.stringify(s.name), "docent:Booth"]], "Next")}
      <invoke operation="${q(plan.travel)}"/>
    </node>
    <node name="${q(s.at + s.repeated)}">${arrive}
${there.map((operation) => `      <invoke operation="${q(operation)}"${text && operation === plan.speak ? `>${text}</invoke>` : "/>"}`).join("\n")}
    </node>`;
    })
    .join("\n\n");
  const names = ["Begin", ...steps.flatMap((s) => [s.go + s.repeated, s.at + s.repeated]), "End"];
  const links = names
    .slice(1)
    .map((name, i) => `    <link from="${q(names[i] ?? "")}" to="${q(name)}"/>`)
    .join("\n");
  return `<?xml version="1.0" encoding="UTF-8"?>
<CAWL name="${q(plan.name)}" version="1.0"
      xmlns:docent="https://w3id.org/docent#"
      xmlns:ext="https://w3id.org/docent/cawl-ext#"
      xmlns:schema="https://schema.org/"
      xmlns:xsd="http://www.w3.org/2001/XMLSchema#"${declared}>

  <flow name="${q(plan.name)}">
    <documentation>A tour of ${plan.stops.length} stops: ${encodeText(plan.stops.map((s) => s.name).join(", "))}.</documentation>
    <variable name="user" type="docent:Visitor"/>
    <variable name="robot" type="docent:Robot"/>
    <variable name="booth" type="docent:Booth"/>${said ? '\n    <variable name="text" type="xsd:string"/>' : ""}

    <source name="Begin"/>

${nodes}

    <sink name="End"/>

${links}
  </flow>
</CAWL>
`;
}
