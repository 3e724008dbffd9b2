// The hall live: booths and regions from the graph, robots with pose, trail and task, people where they are.
import { Bot, LocateFixed, Map as MapIcon, Minus, Plus, QrCode, Route, Unplug, User, X } from "lucide-react";
import { useEffect, useMemo, useRef, useState } from "react";
import { useAsOf, useKept, useShown } from "../api/as_of";
import { fleet } from "../api/client";
import { useFollow } from "../api/live";
import { useNames, type Names } from "../api/prefixes";
import { query } from "../api/sparql";
import { useCommands } from "../app/commands";
import { usePast } from "../app/past";
import { Link } from "../app/link";
import { navigate, paths } from "../app/router";
import { words } from "../cawl/names";
import { ListRobotsReplySchema, type RobotStatus } from "../gen/docent/v1/fleet_pb";
import { attempt } from "./run_actions";
import { HallDrawing, type Camera } from "./hall_drawing";
import { type Layout, useLayout, usePeople } from "./layout";
import { askRobots } from "./past_hall";
import { clock } from "./states";
import { TourPanel } from "./tour_panel";
import type { Stop } from "../cawl/tour";
import { Fact } from "./why";
import "./hall.css";

export function useRobots() {
  const at = usePast();
  const now = useFollow(at === null ? "robots" : "", { call: "docent.v1.Fleet/List", request: {}, reply: ListRobotsReplySchema, poll: (signal) => fleet.list({}, { signal }), everyMs: 150 });
  const then = useAsOf("robots", at, askRobots);
  return useKept("robots", at === null ? now : then);
}

export default function Hall({ picked }: { picked: string }) {
  const layout = useLayout();
  const robots = useRobots();
  const people = usePeople();
  const names = useNames();
  const [camera, setCamera] = useState<Camera | null>(null);
  const pickedIri = picked ? names.long(picked) : "";
  const [tour, setTour] = useState<Stop[] | null>(null);
  const past = usePast() !== null;
  const pickTour = (iri: string) => {
    const shape = layout.data?.shapes.find((s) => s.iri === iri && s.kind === "booth");
    if (shape && tour) setTour([...tour, { iri, term: names.short(iri) || `<${iri}>`, name: shape.name, x: shape.label.x, y: shape.label.y }]);
  };
  const pick = (iri: string) => navigate(paths.hall(iri === pickedIri ? "" : iri && (names.short(iri) || iri)), true);
  const trails = useTrails(robots.data?.robots, past);
  useEffect(() => void (document.title = "Hall – Docent"), []);
  const list = robots.data?.robots ?? [];
  useCommands([
    { title: "Show the whole hall", group: "Hall", icon: LocateFixed, keys: "F", run: () => setCamera(null) },
    { title: "Nearer", group: "Hall", icon: Plus, keys: "+|=", run: () => setCamera((c) => zoomed(c, layout.data, 0.8)) },
    { title: "Farther", group: "Hall", icon: Minus, keys: "-", run: () => setCamera((c) => zoomed(c, layout.data, 1.25)) },
    { title: "Select nothing", group: "Hall", keys: "Escape", hidden: true, run: () => pick("") },
    { title: "New tour from the map", group: "Hall", icon: Route, keys: "T", words: "booths workflow", run: () => setTour([]) },
    ...list.map((r) => ({ title: `Show robot ${r.label || names.name(r.robot)}`, group: "Hall", icon: Bot, run: () => pick(r.robot) })),
    ...(layout.data?.shapes ?? []).filter((s) => ["booth", "region"].includes(s.kind)).map((s) => ({ title: `Show ${s.name}`, group: "Hall", icon: MapIcon, words: s.detail, run: () => pick(s.iri) })),
  ]);
  const empty = layout.data?.shapes.length === 0 && list.length === 0;
  return (
    <main className="page hall">
      <div className="hall-stage">
        {layout.error && !layout.data && <div className="nothing"><Unplug size={28} /><h2>{layout.error.title}</h2><p>{layout.error.detail}</p></div>}
        {empty && <div className="nothing"><MapIcon size={28} /><h2>No hall is described yet</h2><p>Load a description of the place, with geometries of its regions: <code>docent load hall.ttl</code>. Robots appear when their adapters join.</p></div>}
        {layout.data && !empty && <HallDrawing layout={layout.data} robots={list} people={people.data ?? []} trails={trails} picked={pickedIri} camera={camera} onCamera={setCamera} onPick={tour ? pickTour : pick} {...(tour && { tour })} />}
        {!tour && !past && layout.data && layout.data.shapes.some((s) => s.kind === "booth") && <button className="button hall-tour" title="Booths in order become a workflow (T)" onClick={() => setTour([])}><Route size={14} />New tour</button>}
        <div className="hall-zoom">
          <button className="button icon" aria-label="Nearer" onClick={() => setCamera((c) => zoomed(c, layout.data, 0.8))}><Plus size={15} /></button>
          <button className="button icon" aria-label="Farther" onClick={() => setCamera((c) => zoomed(c, layout.data, 1.25))}><Minus size={15} /></button>
          <button className="button icon" aria-label="Show the whole hall" title="Show the whole hall (F)" onClick={() => setCamera(null)}><LocateFixed size={15} /></button>
        </div>
      </div>
      <aside className="dock hall-side" aria-label="Robots and people">
        {tour ? <TourPanel stops={tour} from={list[0]?.hasPose ? { x: list[0].xM, y: list[0].yM } : null} names={names} onStops={setTour} onClose={() => setTour(null)} /> : pickedIri ? <Details key={pickedIri} iri={pickedIri} robots={list} layout={layout.data} names={names} onClose={() => pick("")} again={robots.again} /> : (
          <>
            <h2 className="hall-title">Robots <span className="faint number">{list.length}</span></h2>
            {list.length === 0 && <p className="faint small hall-hint">{robots.error ? robots.error.title : "None has joined. Start one: docent-robot."}</p>}
            <ul>{list.map((r) => <RobotRow key={r.robot} robot={r} names={names} onPick={pick} />)}</ul>
            <h2 className="hall-title">People <span className="faint number">{people.data?.length ?? 0}</span></h2>
            <ul>{(people.data ?? []).slice(0, 100).map((p) => <li key={p.iri}><button className="hall-row" onClick={() => pick(p.iri)}><span className="hall-icon person"><User size={14} /></span><span className="grow cut"><b>{p.name || names.name(p.iri)}</b><span className="faint small">{p.at ? `at ${names.name(p.at)}` : "somewhere"}</span></span></button></li>)}</ul>
          </>
        )}
      </aside>
    </main>
  );
}

function zoomed(camera: Camera | null, layout: Layout | undefined, by: number): Camera | null {
  const now = camera ?? (layout ? { x: (layout.min.x + layout.max.x) / 2, y: (layout.min.y + layout.max.y) / 2, scale: 1 } : null);
  return now && { ...now, scale: Math.max(0.08, Math.min(1.6, now.scale * by)) };
}

const trailPoints = 240;
const leapM = 4;

// Of now, or of the past as far as it was played; a leap begins another one.
function useTrails(robots: readonly RobotStatus[] | undefined, past: boolean): ReadonlyMap<string, { x: number; y: number }[]> {
  const trails = useRef(new Map<string, { x: number; y: number }[]>());
  const ofPast = useRef(past);
  return useMemo(() => {
    if (ofPast.current !== past) trails.current.clear();
    ofPast.current = past;
    for (const r of robots ?? []) {
      if (!r.hasPose) continue;
      const trail = trails.current.get(r.robot) ?? [];
      const last = trail.at(-1);
      const far = last ? Math.hypot(last.x - r.xM, last.y - r.yM) : 0;
      if (!last || far > 0.08) trails.current.set(r.robot, [...(past && far > leapM ? [] : trail.slice(-trailPoints)), { x: r.xM, y: r.yM }]);
    }
    return new Map(trails.current);
  }, [robots, past]);
}

export function taskWords(robot: RobotStatus): string {
  if (robot.outOfService) return `out of service${robot.outOfServiceReason ? `: ${robot.outOfServiceReason}` : ""}`;
  const task = robot.heldFor[0];
  if (task) return words(task.operation);
  if (robot.endingCommands.length > 0) return "ends a command";
  return robot.heldBy ? "waits for its run" : robot.state === "standby" ? "free" : "";
}

export function RobotTag({ state }: { state: string }) {
  const tone = { standby: "good", busy: "busy", charging: "wait", offline: "bad" }[state] ?? "";
  return <span className={`tag ${tone}`}>{state}</span>;
}

function RobotRow({ robot, names, onPick }: { robot: RobotStatus; names: Names; onPick: (iri: string) => void }) {
  return (
    <li>
      <button className="hall-row" onClick={() => onPick(robot.robot)}>
        <span className="hall-icon robot"><Bot size={14} /></span>
        <span className="grow cut"><b>{robot.label || names.name(robot.robot)}</b><span className="faint small cut">{[taskWords(robot), robot.regions[0] && `at ${names.name(robot.regions[0])}`].filter(Boolean).join(", ")}</span></span>
        <RobotTag state={robot.outOfService ? "maintenance" : robot.state} />
      </button>
    </li>
  );
}

function Details(props: { iri: string; robots: readonly RobotStatus[]; layout: Layout | undefined; names: Names; onClose: () => void; again: () => void }) {
  const { iri, names } = props;
  const past = usePast() !== null;
  const robot = props.robots.find((r) => r.robot === iri);
  const shape = props.layout?.shapes.find((s) => s.iri === iri);
  const facts = useShown(`facts ${iri}`, (asOf, signal) => query(`SELECT ?p ?o { <${iri.replace(/[<>"{}|^\`\\\s]/g, "")}> ?p ?o FILTER(!isBlank(?o)) } ORDER BY ?p LIMIT 60`, signal, asOf), 1500);
  const word = (v: { kind: string; text: string; datatype?: string } | undefined) => (!v ? "" : v.kind === "iri" ? names.short(v.text) || `<${v.text}>` : /integer|decimal|boolean|double/.test(v.datatype ?? "") ? v.text : JSON.stringify(v.text));
  const here = props.robots.filter((r) => r.regions.includes(iri));
  return (
    <>
      <header className="properties-head">
        <span className={`hall-icon ${robot ? "robot" : shape ? "booth" : "person"}`}>{robot ? <Bot size={15} /> : shape ? <MapIcon size={15} /> : <User size={15} />}</span>
        <span className="grow cut" style={{ fontWeight: 600, fontSize: "var(--text-l)" }}>{robot?.label || shape?.name || names.name(iri)}</span>
        {robot && <RobotTag state={robot.outOfService ? "maintenance" : robot.state} />}
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}><X size={15} /></button>
      </header>
      <div className="hall-details" tabIndex={0} aria-label="Details">
        {shape?.detail && <p className="quiet">{shape.detail}</p>}
        {robot && (
          <>
            <p className="quiet">{taskWords(robot)}{robot.heldFor[0]?.step ? `, step ${robot.heldFor[0].step}` : ""}{robot.heldBy && <> for <Link href={paths.run(robot.heldBy, robot.heldFor[0]?.node ?? "")}>{robot.heldBy}</Link></>}</p>
            {robot.hasPose && <p className="faint small number">{robot.xM.toFixed(2)} m, {robot.yM.toFixed(2)} m, {Math.round((robot.headingRad * 180) / Math.PI)}°</p>}
            {robot.state === "offline" && robot.lastSeenUs > 0n && <p className="faint small">last seen {clock(robot.lastSeenUs)}</p>}
            {!past && <div className="row">
              {robot.outOfService
                ? <button className="button small" onClick={() => attempt("The robot is in service", () => fleet.putInService({ robot: iri }), props.again)}>Put in service</button>
                : <button className="button small" title="It gets no further command; what it does ends" onClick={() => attempt("The robot is out of service", () => fleet.takeOutOfService({ robot: iri, cancelCommands: false, reason: "" }), props.again)}>Take out of service</button>}
            </div>}
            <p className="row" style={{ flexWrap: "wrap", gap: 5 }}>{robot.operations.map((o) => <span key={o} className="tag">{words(o)}</span>)}</p>
          </>
        )}
        {shape && ["booth", "region"].includes(shape.kind) && <p><a className="button small" href={`/visit/code.svg?${new URLSearchParams({ at: names.short(iri) || iri, base: location.origin, label: shape.name })}`} target="_blank" rel="noreferrer"><QrCode size={13} />Code for visitors’ phones</a></p>}
        {here.length > 0 && <p className="quiet">Here: {here.map((r) => r.label || names.name(r.robot)).join(", ")}</p>}
        <h3>Facts</h3>
        {facts.error && !facts.data && <p className="faint small">{facts.error.title}</p>}
        <ul>{(facts.data?.rows ?? []).map((row) => {
          const fact = [names.short(iri) || `<${iri}>`, word(row["p"]), word(row["o"])];
          return <Fact key={fact.join(" ")} words={fact} names={names} short />;
        })}</ul>
      </div>
    </>
  );
}
